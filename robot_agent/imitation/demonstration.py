"""Which part of an observation is the demonstration: stops, gaps, and the return trip to the start."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.trajectory import SmoothedTrajectory, Stop

BLIP_CELLS = 0.4
"""A drive shorter than this is noise: 5 cm in cells of 12 cm."""


def find_stops(trajectory: SmoothedTrajectory, cell_m: float) -> SmoothedTrajectory:
    """With every stop; a drive that the first or the last frame cuts has no rest there."""
    stops: list[Stop] = []
    for first, last in _runs(trajectory.stands):
        stop = Stop(first, last)
        if stops and _is_blip(trajectory, stops[-1], stop, cell_m):
            stops[-1] = Stop(stops[-1].first, last)
        else:
            stops.append(stop)
    return trajectory.with_stops(tuple(stops))


def _is_blip(trajectory: SmoothedTrajectory, before: Stop, after: Stop, cell_m: float) -> bool:
    """Whether what looked like a drive led nowhere."""
    return math.dist(trajectory.place_m(before), trajectory.place_m(after)) < BLIP_CELLS * cell_m


def _runs(chosen: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last index of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], chosen, [False])).astype(np.int8)))
    return [(int(first), int(after) - 1) for first, after in zip(edges[::2], edges[1::2], strict=True)]


Place = tuple[float, float]

LONG_REST_S = 1.2
"""What smoothing and frame rate leave of a rest of 1.5 s; no drive spans it."""
MOST_FALSE_STOPS = 6
"""Chosen: a drive back of 1.5 m takes 15 s and seems to stop a few times; bounds the pairs that are tried."""
LEAST_CELLS = 6 * math.sqrt(2)
"""A drive back is longer than any list of five moves ..."""
MOST_STANDING = 0.15
"""... and in less of its frames the robot seems to stand; an expert's stops take a quarter of them."""
LEAST_CELLS_TO_START = 4.0
MOST_STANDING_TO_START = 0.25
"""Both bounds can be wider if the start is known, and is where the drive ends. Chosen, as all four bounds:
tests/robot_agent/imitation/test_copying.py holds them to tracks with a drive back, seen with noise."""
START_CELLS = 2.5
"""... to within this. Chosen: far positions are uncertain by a cell or two (docs/copying.md)."""


@dataclass(frozen=True, order=True)
class _Drive:
    """A drive from one rest to another."""

    length_m: float
    start: int
    end: int

    def overlaps(self, other: _Drive) -> bool:
        return self.start < other.end and other.start < self.end


def longest_demonstration(
    trajectory: SmoothedTrajectory, cell_m: float, start_m: Place | None = None
) -> SmoothedTrajectory:
    """With only the stops of the longest demonstration: its first, those between its moves, and its last.

    Demonstrations are what lies before, between and after drives back. A longer rest alone does not part
    two, since a slow turn can take 1.5 s as well. Fewer than two rests mean that nothing was shown.
    """
    stops = trajectory.stops
    drives = sorted(_drives_back(trajectory, cell_m, start_m), key=lambda drive: drive.start)
    firsts = [0, *(drive.end for drive in drives)]
    lasts = [*(drive.start for drive in drives), len(stops) - 1]
    parts = [stops[first : last + 1] for first, last in zip(firsts, lasts, strict=True)]
    longest: tuple[Stop, ...] = max(parts, key=lambda part: len(part))
    return trajectory.with_stops(longest)


def _drives_back(trajectory: SmoothedTrajectory, cell_m: float, start_m: Place | None) -> list[_Drive]:
    """The longest drives that look like a drive back and do not overlap."""
    stops = trajectory.stops
    standing = np.concatenate(([0], np.cumsum(trajectory.stands)))
    chosen: list[_Drive] = []
    for drive in sorted(_candidates(trajectory), reverse=True):
        first, after = stops[drive.start].last + 1, stops[drive.end].first
        share = (standing[after] - standing[first]) / max(after - first, 1)
        ends_at_start = _near(trajectory, stops[drive.end], start_m, cell_m)
        if start_m is None or ends_at_start:
            least = LEAST_CELLS_TO_START if ends_at_start else LEAST_CELLS
            most = MOST_STANDING_TO_START if ends_at_start else MOST_STANDING
            steady = drive.length_m > least * cell_m and share < most
            chosen += [drive] if steady and not any(map(drive.overlaps, chosen)) else []
    return chosen


def _candidates(trajectory: SmoothedTrajectory) -> list[_Drive]:
    """From every rest to the next ones, without a long rest in between."""
    stops = trajectory.stops
    places_m = [trajectory.place_m(stop) for stop in stops]
    drives: list[_Drive] = []
    for start in range(len(stops)):
        for end in range(start + 1, min(start + 2 + MOST_FALSE_STOPS, len(stops))):
            drives.append(_Drive(math.dist(places_m[start], places_m[end]), start, end))
            if trajectory.duration_s(stops[end]) >= LONG_REST_S:
                break
    return drives


def _near(trajectory: SmoothedTrajectory, stop: Stop, start_m: Place | None, cell_m: float) -> bool:
    return start_m is not None and math.dist(trajectory.place_m(stop), start_m) < START_CELLS * cell_m


LONGEST_GAP_S = 1.05
"""About half of a move."""
LONGEST_GAP_FRAMES = 3.5
"""At a low frame rate a lost frame or two are no reason yet."""


def longest_in_sight(trajectory: SmoothedTrajectory) -> SmoothedTrajectory:
    """With only the stops of the longest part in which the demonstrator was never lost for long.

    A gap within a rest ends one part there and begins the next: the demonstrator may have gone and returned.
    """
    stops = trajectory.stops
    if not stops:
        return trajectory
    parts: list[list[Stop]] = [[stops[0]]]
    lost = _long_gaps(trajectory)
    for before, stop in zip([None, *stops[:-1]], stops, strict=True):
        if before and lost[before.last : stop.first].any():
            parts.append([])
        if before:
            parts[-1].append(stop)
        if lost[stop.first : stop.last].any():
            parts.append([stop])
    longest = max(parts, key=lambda part: len(part))
    return trajectory.with_stops(tuple(longest))


def _long_gaps(trajectory: SmoothedTrajectory) -> NDArray[np.bool_]:
    """Whether the demonstrator was lost for long after each position."""
    gaps_s = np.diff(trajectory.t_s)
    return np.asarray(gaps_s > max(LONGEST_GAP_S, LONGEST_GAP_FRAMES * float(np.median(gaps_s))))
