"""Hats: pins on a grid, and how different two patterns of pins are."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from tracker_bridge.hats.alignment import Points, orders, residuals

Floats = npt.NDArray[np.float64]

PAIRS_AT_ONCE = 20_000
"""Pairs of patterns compared in one stroke: 20,000 x 24 orders x 4 pins are 30 MB."""


@dataclass(frozen=True)
class PinGrid:
    """Holes for pins on a plate over a robot's axis: columns to the left, rows ahead, within a radius.

    The default fits an e-puck (70 mm): markers of 8 mm stay inside its outline.
    """

    columns: int = 5
    rows: int = 5
    pitch_m: float = 0.013
    radius_m: float = 0.034

    @property
    def holes(self) -> list[complex]:
        """Metres ahead (real) and to the left (imaginary) of the robot's axis, from the front left on."""
        places = [
            complex((self.rows - 1) / 2 - row, (self.columns - 1) / 2 - column) * self.pitch_m
            for row in range(self.rows)
            for column in range(self.columns)
        ]
        return [place for place in places if abs(place) <= self.radius_m + 1e-9]


@dataclass(frozen=True)
class Hat:
    """A robot's pattern: where its pins stand, in metres ahead (real) and to the left (imaginary)."""

    name: str
    pins: tuple[complex, ...]


def difference_m(pins: Points, others: Points) -> Floats:
    """(n, m): how different patterns (n, k) and (m, k) are: the largest distance of a pin from its partner
    after the best alignment, for the best pairing of pins. Mirror images differ: hats are seen from above."""
    result = np.empty((len(pins), len(others)))
    rows = max(1, PAIRS_AT_ONCE // len(others))
    every = others[:, orders(others.shape[1])]
    for first in range(0, len(pins), rows):
        some = pins[first : first + rows, None, None, :]
        result[first : first + rows] = residuals(some, every[None]).max(-1).min(-1)
    return result


def self_difference_m(pins: Points) -> Floats:
    """(n,): how different each pattern is from itself with pins paired otherwise: 0 if it is symmetric."""
    others = orders(pins.shape[1])[1:]
    return np.asarray(residuals(pins[:, None, :], pins[:, others]).max(-1).min(-1))


def every_pattern(grid: PinGrid, pins: int, spacing_m: float) -> Points:
    """(n, pins): one of each kind of pattern with pins at least `spacing_m` apart; kinds that a turn by a
    quarter or a shift makes equal are one."""
    kinds: dict[tuple[tuple[int, int], ...], tuple[complex, ...]] = {}
    for chosen in combinations(grid.holes, pins):
        if min(abs(one - other) for one, other in combinations(chosen, 2)) >= spacing_m - 1e-9:
            kinds.setdefault(_kind(chosen, grid.pitch_m), chosen)
    return np.array(list(kinds.values())).reshape(-1, pins)


def _kind(pins: tuple[complex, ...], pitch_m: float) -> tuple[tuple[int, int], ...]:
    """The same for all patterns that quarter turns and shifts make equal."""
    forms = []
    for turn in (1, 1j, -1, -1j):
        cells = [
            (round((pin * turn).real * 2 / pitch_m), round((pin * turn).imag * 2 / pitch_m)) for pin in pins
        ]
        least_x, least_y = min(x for x, _ in cells), min(y for _, y in cells)
        forms.append(tuple(sorted((x - least_x, y - least_y) for x, y in cells)))
    return min(forms)
