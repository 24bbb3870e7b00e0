"""Which part of an observation is the demonstration: the drive back to the start is not.

A demonstrator rests for at least 1.5 s before its moves and after them, and again before and after the long
drive back. It stops after every move, but not on the way back; noise can make it seem to stop there too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robot_agent.imitation.rests import REST_SPEED_M_S, Rest
from robot_agent.imitation.smoothing import Smoothed

Place = tuple[float, float]

LONG_REST_S = 1.2
"""What smoothing and frame rate leave of a rest of 1.5 s; no drive spans it."""
MOST_FALSE_STOPS = 6
LEAST_CELLS = 6 * math.sqrt(2)
"""A drive back is longer than any list of five moves ..."""
MOST_STANDING = 0.15
"""... and in less of its frames the robot seems to stand; an expert's stops take a quarter of them."""
LEAST_CELLS_TO_START = 4.0
MOST_STANDING_TO_START = 0.25
"""Both bounds can be wider if the start is known, and is where the drive ends, to within ..."""
START_CELLS = 2.5


@dataclass(frozen=True, order=True)
class _Drive:
    """A drive from one rest to another."""

    length_m: float
    start: int
    end: int

    def overlaps(self, other: _Drive) -> bool:
        return self.start < other.end and other.start < self.end


def demonstration_rests(
    smoothed: Smoothed, rests: Sequence[Rest], cell_m: float, start_m: Place | None = None
) -> list[Rest]:
    """The rests of the longest demonstration: its first, those between its moves, and its last.

    Demonstrations are what lies before, between and after drives back. A longer rest alone does not part
    two, since a slow turn can take 1.5 s as well. Fewer than two rests mean that nothing was shown.
    """
    drives = sorted(_drives_back(smoothed, rests, cell_m, start_m), key=lambda drive: drive.start)
    firsts = [0, *(drive.end for drive in drives)]
    lasts = [*(drive.start for drive in drives), len(rests) - 1]
    return max((list(rests[a : b + 1]) for a, b in zip(firsts, lasts, strict=True)), key=len)


def _drives_back(
    smoothed: Smoothed, rests: Sequence[Rest], cell_m: float, start_m: Place | None
) -> list[_Drive]:
    """The longest drives that look like a drive back and do not overlap."""
    standing = np.concatenate(([0], np.cumsum(smoothed.speed_m_s <= REST_SPEED_M_S)))
    chosen: list[_Drive] = []
    for drive in sorted(_candidates(smoothed, rests), reverse=True):
        first, after = rests[drive.start].last + 1, rests[drive.end].first
        share = (standing[after] - standing[first]) / max(after - first, 1)
        ends_at_start = _near(smoothed, rests[drive.end], start_m, cell_m)
        if start_m is None or ends_at_start:
            least = LEAST_CELLS_TO_START if ends_at_start else LEAST_CELLS
            most = MOST_STANDING_TO_START if ends_at_start else MOST_STANDING
            steady = drive.length_m > least * cell_m and share < most
            chosen += [drive] if steady and not any(map(drive.overlaps, chosen)) else []
    return chosen


def _candidates(smoothed: Smoothed, rests: Sequence[Rest]) -> list[_Drive]:
    """From every rest to the next ones, without a long rest in between."""
    places_m = [rest.place_m(smoothed) for rest in rests]
    drives: list[_Drive] = []
    for start in range(len(rests)):
        for end in range(start + 1, min(start + 2 + MOST_FALSE_STOPS, len(rests))):
            drives.append(_Drive(math.dist(places_m[start], places_m[end]), start, end))
            if rests[end].duration_s(smoothed) >= LONG_REST_S:
                break
    return drives


def _near(smoothed: Smoothed, rest: Rest, start_m: Place | None, cell_m: float) -> bool:
    return start_m is not None and math.dist(rest.place_m(smoothed), start_m) < START_CELLS * cell_m
