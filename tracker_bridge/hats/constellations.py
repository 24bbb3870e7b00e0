"""Groups of unnamed markers that could be one hat, found by an index of pairwise distances."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tracker_bridge.hats.alignment import Points, residuals

Floats = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]


class DistanceIndex:
    """Patterns (n, k) by the distance of their two pins that are furthest apart.

    Two markers at about that distance say where the pattern's other pins would be seen.
    """

    def __init__(self, patterns: Points, tolerance_m: float) -> None:
        self._tolerance_m = tolerance_m
        between = np.abs(patterns[:, :, None] - patterns[:, None, :]).reshape(len(patterns), -1)
        first, last = np.divmod(between.argmax(1), patterns.shape[1])
        order = np.argsort(between.max(1))
        self._reach_m = between.max(1)[order]
        everyone = np.arange(len(patterns))[:, None]
        rest = np.array(
            [[p for p in range(patterns.shape[1]) if p not in ends] for ends in zip(first, last, strict=True)]
        )
        self._pins = patterns[everyone, np.column_stack([first, last, rest])][order]

    def groups(self, points: Points) -> list[tuple[int, ...]]:
        """Sets of as many points as a pattern has pins that fit one of the patterns, the best fit first;
        no point is in two of them."""
        pairs, kinds = self._candidates(points)
        if not len(kinds):
            return []
        pins = self._pins[kinds]
        turn = (points[pairs[:, 1]] - points[pairs[:, 0]]) / (pins[:, 1] - pins[:, 0])
        turn /= np.abs(turn)
        expected = points[pairs[:, 0], None] + turn[:, None] * (pins[:, 2:] - pins[:, :1])
        apart_m = np.abs(expected[:, :, None] - points)
        nearest = apart_m.argmin(-1)
        fits = (apart_m.min(-1) < self._tolerance_m).all(1)
        members = np.concatenate([pairs, nearest], 1)[fits]
        misses_m = residuals(pins[fits], points[members]).max(1)
        return _disjoint(members, misses_m, self._tolerance_m)

    def _candidates(self, points: Points) -> tuple[Numbers, Numbers]:
        """Ordered pairs of points (m, 2) and, for each, a pattern (m,) that reaches about as far."""
        apart_m = np.abs(points[:, None] - points)
        near = (apart_m >= self._reach_m[0] - self._tolerance_m) & (
            apart_m <= self._reach_m[-1] + self._tolerance_m
        )
        one, other = np.nonzero(near)
        low = np.searchsorted(self._reach_m, apart_m[one, other] - self._tolerance_m)
        high = np.searchsorted(self._reach_m, apart_m[one, other] + self._tolerance_m)
        count = high - low
        owner = np.repeat(np.arange(len(one)), count)
        kinds = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + low[owner]
        return np.column_stack([one[owner], other[owner]]), kinds


def _disjoint(members: Numbers, misses_m: Floats, tolerance_m: float) -> list[tuple[int, ...]]:
    taken: set[int] = set()
    groups = []
    for best in np.argsort(misses_m):
        if misses_m[best] > tolerance_m:
            break
        group = tuple(int(point) for point in members[best])
        if len(set(group)) == len(group) and taken.isdisjoint(group):
            taken.update(group)
            groups.append(group)
    return groups
