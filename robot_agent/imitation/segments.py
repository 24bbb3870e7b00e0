"""The corners of a demonstration, and the straight segments between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robot_agent.imitation.demonstration import Stop
from robot_agent.imitation.positions import Floats, Trajectory, chi2
from robot_agent.imitation.smoothing import Smoothed
from swarm.geometry import wrap_angle_rad

FROZEN_SHARE = 0.5
"""Share of a detection's variance that stays the same while the robot stands still, so that a smoothed
position never becomes better than this."""
BEND_CHI2 = 16.0
"""A drive bends where it leaves its chord by this much, ..."""
BEND_CELLS = 0.65
"""... and both parts must be long enough to be moves."""


@dataclass(frozen=True)
class Segment:
    """A straight drive after a turn on the spot, to the left if positive.

    The first segment of a demonstration has no turn: nobody saw where the demonstrator faced before it.
    """

    turn_rad: float
    length_m: float
    heading_rad: float
    t_start_ns: int
    t_end_ns: int


@dataclass(frozen=True)
class Vertex:
    """A corner: where the demonstrator stopped or turned, and from when until when it was there."""

    xy_m: Floats  # [2]
    covariance_m2: Floats  # [2, 2]
    t_first_ns: int
    t_last_ns: int
    stopped: bool = True
    """Whether it stopped there; a mere bend of the smoothed way may be none of the demonstrator's."""


def find_vertices(
    trajectory: Trajectory, smoothed: Smoothed, stops: Sequence[Stop], cell_m: float
) -> list[Vertex]:
    """The rests, and between them the bends of drives whose stop was too short to be seen."""
    vertices = [_vertex(trajectory, smoothed, stop) for stop in stops[:1]]
    for before, after in pairwise(stops):
        bends = _bends(trajectory, smoothed, before.last, after.first, BEND_CELLS * cell_m)
        vertices += [_bend_vertex(trajectory, smoothed, bend) for bend in bends]
        vertices.append(_vertex(trajectory, smoothed, after))
    return vertices


def _vertex(trajectory: Trajectory, smoothed: Smoothed, stop: Stop) -> Vertex:
    seen = slice(stop.first, stop.last + 1)
    middle = (stop.first + stop.last + 1) // 2
    frozen_m2 = FROZEN_SHARE * trajectory.covariance_m2[seen].mean(axis=0)
    return Vertex(
        stop.place_m(smoothed),
        smoothed.covariance[middle, :2, :2] + frozen_m2,
        int(trajectory.t_ns[stop.first]),
        int(trajectory.t_ns[stop.last]),
    )


def _bend_vertex(trajectory: Trajectory, smoothed: Smoothed, bend: int) -> Vertex:
    covariance_m2 = smoothed.covariance[bend, :2, :2] + FROZEN_SHARE * trajectory.covariance_m2[bend]
    t_ns = int(trajectory.t_ns[bend])
    return Vertex(smoothed.xy_m[bend], covariance_m2, t_ns, t_ns, stopped=False)


def _bends(trajectory: Trajectory, smoothed: Smoothed, start: int, end: int, least_m: float) -> list[int]:
    """Split a drive at its farthest place from the chord, again and again (Ramer, 1972; Douglas and Peucker,
    1973), with the distance measured in units of its own error."""
    corners, waiting = [start], [end]
    while waiting:
        bend = _farthest(trajectory, smoothed, corners[-1], waiting[-1])
        if bend is None or not _parted(smoothed.xy_m[[corners[-1], bend, waiting[-1]]], least_m):
            corners.append(waiting.pop())
        else:
            waiting.append(bend)
    return corners[1:-1]


def _farthest(trajectory: Trajectory, smoothed: Smoothed, start: int, end: int) -> int | None:
    """The place between two others that is farthest from their chord; None if they are on it."""
    inner = slice(start + 1, end)
    if end - start < 2:
        return None
    frozen_m2 = FROZEN_SHARE * trajectory.covariance_m2[inner]
    away_m = from_chord(smoothed.xy_m[inner], smoothed.xy_m[start], smoothed.xy_m[end])
    distances = chi2(away_m, smoothed.covariance[inner, :2, :2] + frozen_m2)
    farthest = int(np.argmax(distances))
    return start + 1 + farthest if distances[farthest] > BEND_CHI2 else None


def from_chord(xy_m: Floats, start_m: Floats, end_m: Floats) -> Floats:
    """The shortest vectors [N, 2] from a chord to places [N, 2]."""
    chord_m = end_m - start_m
    square_m2 = float(chord_m @ chord_m)
    along = np.clip((xy_m - start_m) @ chord_m / square_m2, 0.0, 1.0) if square_m2 else np.zeros(len(xy_m))
    away: Floats = xy_m - start_m - along[:, None] * chord_m
    return away


def _parted(corners_m: Floats, least_m: float) -> bool:
    return all(math.dist(a, b) >= least_m for a, b in pairwise(corners_m))


def segments_between(vertices: Sequence[Vertex]) -> tuple[Segment, ...]:
    """The straight drives from each vertex to the next, with the turns between them."""
    segments: list[Segment] = []
    for start, end in pairwise(vertices):
        dx_m, dy_m = end.xy_m - start.xy_m
        heading_rad = math.atan2(dy_m, dx_m)
        turn_rad = wrap_angle_rad(heading_rad - segments[-1].heading_rad) if segments else 0.0
        length_m = math.hypot(dx_m, dy_m)
        segments.append(Segment(turn_rad, length_m, heading_rad, start.t_last_ns, end.t_first_ns))
    return tuple(segments)
