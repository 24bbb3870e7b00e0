"""When the demonstrator stood still."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.sightings import Floats
from robot_agent.imitation.smoothing import Smoothed

REST_SPEED_M_S = 0.05
BLIP_CELLS = 0.4
"""A drive shorter than this is noise: 5 cm in cells of 12 cm."""


@dataclass(frozen=True)
class Rest:
    """The positions `first` to `last`, both of them seen while the demonstrator stood still."""

    first: int
    last: int

    def duration_s(self, smoothed: Smoothed) -> float:
        return float(smoothed.t_s[self.last] - smoothed.t_s[self.first])

    def place_m(self, smoothed: Smoothed) -> Floats:
        """The mean of the positions at rest; a blip in between does not count."""
        seen = slice(self.first, self.last + 1)
        standing = smoothed.speed_m_s[seen] <= REST_SPEED_M_S
        mean: Floats = smoothed.xy_m[seen][standing].mean(axis=0)
        return mean


def find_rests(smoothed: Smoothed, cell_m: float) -> list[Rest]:
    """Every stop in the order of time; a drive that the first or the last frame cuts has no rest there."""
    rests: list[Rest] = []
    for first, last in _runs(smoothed.speed_m_s <= REST_SPEED_M_S):
        rest = Rest(first, last)
        if rests and _is_blip(smoothed, rests[-1], rest, cell_m):
            rests[-1] = Rest(rests[-1].first, last)
        else:
            rests.append(rest)
    return rests


def _is_blip(smoothed: Smoothed, before: Rest, after: Rest, cell_m: float) -> bool:
    """Whether what looked like a drive led nowhere."""
    return math.dist(before.place_m(smoothed), after.place_m(smoothed)) < BLIP_CELLS * cell_m


def _runs(chosen: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], chosen, [False])).astype(np.int8)))
    return [(int(first), int(after) - 1) for first, after in zip(edges[::2], edges[1::2], strict=True)]
