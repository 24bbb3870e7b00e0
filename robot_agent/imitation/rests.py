"""When the demonstrator stood still, and which of its drives were the demonstration.

A demonstrator rests for at least 1.5 s before its moves and after them, and again before and after the
long drive back to the start, which is not part of what it shows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.sightings import Floats
from robot_agent.imitation.smoothing import Smoothed

REST_SPEED_M_S = 0.05
BLIP_CELLS = 0.4
"""A drive shorter than this is noise: 5 cm in cells of 12 cm."""
LONG_REST_S = 1.2
"""What is left of a rest of 1.5 s when the smoothing and the frame rate have worn its edges."""
DRIVE_BACK_CELLS = 6 * math.sqrt(2)
"""A drive back is longer than any list of five moves, ..."""
DRIVE_BACK_STRETCH_CELLS = 3 * math.sqrt(2)
"""... and has no more than one stop in this length; a demonstrator stops after every move."""


@dataclass(frozen=True)
class Rest:
    """The positions `first` to `last`, both of them seen while the demonstrator stood still."""

    first: int
    last: int

    def duration_s(self, smoothed: Smoothed) -> float:
        return float(smoothed.t_s[self.last] - smoothed.t_s[self.first])

    def is_long(self, smoothed: Smoothed) -> bool:
        return self.duration_s(smoothed) >= LONG_REST_S

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


def demonstration_rests(smoothed: Smoothed, rests: Sequence[Rest], cell_m: float) -> list[Rest]:
    """The rests of the longest demonstration: its first, those between its moves, and its last.

    Bouts are what lies between long rests. A bout that is a drive back parts two demonstrations; other
    bouts that follow each other belong together, since a slow turn can also take 1.5 s.
    """
    demonstrations: list[list[Rest]] = [[]]
    for bout in _bouts(smoothed, rests):
        if _is_drive_back(smoothed, bout, cell_m):
            demonstrations.append([])
        else:
            demonstrations[-1] += bout[1:] if demonstrations[-1] else bout
    return max(demonstrations, key=len)


def _bouts(smoothed: Smoothed, rests: Sequence[Rest]) -> list[list[Rest]]:
    """Runs of rests that begin and end with a long rest, or with the first or last one."""
    if len(rests) < 2:
        return []
    inner = [i for i in range(1, len(rests) - 1) if rests[i].is_long(smoothed)]
    return [list(rests[a : b + 1]) for a, b in pairwise([0, *inner, len(rests) - 1])]


def _is_drive_back(smoothed: Smoothed, bout: Sequence[Rest], cell_m: float) -> bool:
    """Far from one end to the other with hardly a stop."""
    length_m = math.dist(smoothed.xy_m[bout[0].last], smoothed.xy_m[bout[-1].first])
    stretches = len(bout) - 1
    far = length_m > DRIVE_BACK_CELLS * cell_m
    return far and length_m >= stretches * DRIVE_BACK_STRETCH_CELLS * cell_m
