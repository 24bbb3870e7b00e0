"""Which hat a group of markers is: every way to see a hat, and how badly each fits."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tracker_bridge.hats.alignment import Points, orders, residuals

Floats = npt.NDArray[np.float64]


class Catalogue:
    """Every way to see some hats (n, k): whole or without one pin, the markers in any order."""

    def __init__(self, hats: Points) -> None:
        self._hats = hats
        pins = hats.shape[1]
        self._ways = {seen: np.unique(orders(pins)[:, :seen], axis=0) for seen in (pins, pins - 1)}

    def misfits_m2(self, points: Points) -> Floats:
        """(ways,): the sums of squared residuals of a group of points, one for each way."""
        shapes = self._hats[:, self._ways[len(points)]].reshape(-1, len(points))
        return np.asarray((residuals(shapes, points) ** 2).sum(-1))

    def without(self, misfits_m2: Floats, hats: list[int]) -> Floats:
        """The same with infinite misfits for hats that it cannot be."""
        left = misfits_m2.reshape(len(self._hats), -1).copy()
        left[hats] = np.inf
        return left.ravel()

    def way(self, number: int, seen: int) -> tuple[int, list[int]]:
        """The hat and, for each marker of the group, its pin, of a place in `misfits_m2`."""
        hat, way = divmod(number, len(self._ways[seen]))
        return hat, [int(pin) for pin in self._ways[seen][way]]


def margin(misfits_m2: Floats, noise_m: float) -> float:
    """By how much the best way beats the second best, as a logarithm of their likelihoods' ratio."""
    best, second = np.partition(misfits_m2, 1)[:2]
    return float((second - best) / (2 * noise_m**2)) if np.isfinite(best) else 0.0
