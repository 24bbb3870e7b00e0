"""The corners of a demonstration, and the straight segments between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from robot_agent.imitation.polyline import from_chord, split
from robot_agent.imitation.trajectory import Floats, SmoothedTrajectory, Stop, chi2
from swarm.geometry import wrap_angle_rad

FROZEN_SHARE = 0.5
"""Share of a detection's variance that stays the same while the robot stands still, so that a smoothed
position never becomes better than this. Most of an edge's error depends on the place within a pixel."""
BEND_CHI2 = 16.0
"""A drive bends where it leaves its chord by four standard deviations, ..."""
BEND_CELLS = 0.65
"""... and both parts must be long enough to be moves: chosen between a whole cell and the half that
rounds to none."""


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


def find_vertices(trajectory: SmoothedTrajectory, cell_m: float) -> list[Vertex]:
    """The stops, and between them the bends of drives whose stop was too short to be seen."""
    vertices = [_vertex(trajectory, stop) for stop in trajectory.stops[:1]]
    for before, after in pairwise(trajectory.stops):
        bends = split(before.last, after.first, partial(_bend, trajectory, BEND_CELLS * cell_m))[1:-1]
        vertices += [_bend_vertex(trajectory, bend) for bend in bends]
        vertices.append(_vertex(trajectory, after))
    return vertices


def _vertex(trajectory: SmoothedTrajectory, stop: Stop) -> Vertex:
    within = slice(stop.first, stop.last + 1)
    middle = (stop.first + stop.last + 1) // 2
    frozen_m2 = FROZEN_SHARE * trajectory.seen.covariance_m2[within].mean(axis=0)
    return Vertex(
        trajectory.place_m(stop),
        trajectory.covariance_m2[middle] + frozen_m2,
        int(trajectory.t_ns[stop.first]),
        int(trajectory.t_ns[stop.last]),
    )


def _bend_vertex(trajectory: SmoothedTrajectory, bend: int) -> Vertex:
    covariance_m2 = trajectory.covariance_m2[bend] + FROZEN_SHARE * trajectory.seen.covariance_m2[bend]
    t_ns = int(trajectory.t_ns[bend])
    return Vertex(trajectory.xy_m[bend], covariance_m2, t_ns, t_ns, stopped=False)


def _bend(trajectory: SmoothedTrajectory, least_m: float, start: int, end: int) -> int | None:
    """The place between two others that is farthest from their chord, in units of its own error.

    None if they are all on it, or if a part would be too short to be a move.
    """
    inner = slice(start + 1, end)
    if end - start < 2:
        return None
    xy_m, frozen_m2 = trajectory.xy_m, FROZEN_SHARE * trajectory.seen.covariance_m2[inner]
    away_m = from_chord(xy_m[inner], xy_m[start], xy_m[end])
    distances = chi2(away_m, trajectory.covariance_m2[inner] + frozen_m2)
    farthest = int(np.argmax(distances))
    bend = start + 1 + farthest
    bends = distances[farthest] > BEND_CHI2 and _parted(xy_m[[start, bend, end]], least_m)
    return bend if bends else None


def _parted(corners_m: Floats, least_m: float) -> bool:
    return all(math.dist(a, b) >= least_m for a, b in pairwise(corners_m))


def segments_between(vertices: Sequence[Vertex]) -> tuple[Segment, ...]:
    """The straight drives from each vertex to the next."""
    spans_ns = [(start.t_last_ns, end.t_first_ns) for start, end in pairwise(vertices)]
    return straight_segments([vertex.xy_m for vertex in vertices], spans_ns)


def straight_segments(
    corners_m: Sequence[Floats], spans_ns: Sequence[tuple[int, int]]
) -> tuple[Segment, ...]:
    """Through N + 1 corners N segments, each from one time to another, with the turns between them."""
    segments: list[Segment] = []
    for (start_m, end_m), (t_start_ns, t_end_ns) in zip(pairwise(corners_m), spans_ns, strict=True):
        dx_m, dy_m = end_m - start_m
        heading_rad = math.atan2(dy_m, dx_m)
        turn_rad = wrap_angle_rad(heading_rad - segments[-1].heading_rad) if segments else 0.0
        segments.append(Segment(turn_rad, math.hypot(dx_m, dy_m), heading_rad, t_start_ns, t_end_ns))
    return tuple(segments)
