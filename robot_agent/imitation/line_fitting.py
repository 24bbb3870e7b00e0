"""Regression line fitting with split and merge: the paper's "straight line segments and their intersections".

Split the positions (their running median, else single bad ones split everything) at the farthest from
the chord, fit each part with the line of least squared distances, merge neighbours in the same
direction, and intersect what remains. It knows nothing of stops, of time, or of how well each
position was seen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from robot_agent.imitation.polyline import from_chord, split
from robot_agent.imitation.segments import Segment, straight_segments
from robot_agent.imitation.trajectory import Floats, Trajectory
from swarm.geometry import MOVES, Move

SPLIT_CELLS = 0.3
"""A part bends if a position is farther from its chord: 3.6 cm in cells of 12 cm."""
MEDIAN_WINDOW = 5
"""Bears two bad positions in a row, like the gate before it."""
MERGE_RAD = math.pi / MOVES
"""Neighbours closer in direction than half the angle between two headings are one line."""
PARALLEL_RAD = math.pi / 18
"""Lines closer in direction than this have no useful intersection."""


@dataclass(frozen=True)
class Line:
    """The line through the positions `first` to `last`, in the direction of travel."""

    first: int
    last: int
    middle_m: Floats  # [2]
    direction: Floats  # [2] of length 1

    def project(self, xy_m: Floats) -> Floats:
        """The nearest place on the line."""
        nearest: Floats = self.middle_m + (xy_m - self.middle_m) @ self.direction * self.direction
        return nearest

    def angle_rad(self, other: Line) -> float:
        """From this direction to the other's, to the left."""
        along, across = self.direction @ other.direction, _cross(self.direction, other.direction)
        return math.atan2(across, along)


def fit_segments(trajectory: Trajectory, cell_m: float) -> tuple[Segment, ...]:
    """Straight segments between the intersections of the fitted lines."""
    if len(trajectory) < 2:
        return ()
    xy_m, t_ns = trajectory.xy_m, trajectory.t_ns
    ends = split_at_bends(running_median(xy_m), SPLIT_CELLS * cell_m)
    lines = merge(xy_m, [fit_line(xy_m, first, last) for first, last in pairwise(ends)])
    spans_ns = [(int(t_ns[line.first]), int(t_ns[line.last])) for line in lines]
    return straight_segments(_corners(xy_m, lines), spans_ns)


def running_median(xy_m: Floats) -> Floats:
    """Of each position and the two on either side, the first and last repeated beyond the ends."""
    around = np.arange(len(xy_m))[:, None] + np.arange(MEDIAN_WINDOW) - MEDIAN_WINDOW // 2
    medians: Floats = np.median(xy_m[np.clip(around, 0, len(xy_m) - 1)], axis=1)
    return medians


def split_at_bends(xy_m: Floats, tolerance_m: float) -> list[int]:
    """Ends of the parts: first and last position, and wherever a part bends by more than the tolerance."""
    return split(0, len(xy_m) - 1, partial(_bend, xy_m, tolerance_m))


def _bend(xy_m: Floats, tolerance_m: float, first: int, last: int) -> int | None:
    """The place that is farthest from a chord, if it is by more than the tolerance."""
    away_m = np.linalg.norm(from_chord(xy_m[first : last + 1], xy_m[first], xy_m[last]), axis=1)
    farthest = int(np.argmax(away_m))
    return first + farthest if away_m[farthest] > tolerance_m else None


def fit_line(xy_m: Floats, first: int, last: int) -> Line:
    """Least squared distances: through the mean, along the direction of the largest scatter."""
    part_m = xy_m[first : last + 1]
    middle_m = part_m.mean(axis=0)
    direction = np.linalg.eigh((part_m - middle_m).T @ (part_m - middle_m))[1][:, 1]
    onward = float(direction @ (part_m[-1] - part_m[0])) >= 0
    return Line(first, last, middle_m, direction if onward else -direction)


def merge(xy_m: Floats, lines: Sequence[Line]) -> list[Line]:
    """Refit neighbours that go the same way as one line, from the first to the last."""
    merged: list[Line] = []
    for line in lines:
        if merged and abs(merged[-1].angle_rad(line)) < MERGE_RAD:
            merged[-1] = fit_line(xy_m, merged[-1].first, line.last)
        else:
            merged.append(line)
    return merged


def _corners(xy_m: Floats, lines: Sequence[Line]) -> list[Floats]:
    """Where the first line begins, neighbours intersect, and the last one ends."""
    inner = [_intersection(a, b, xy_m[a.last]) for a, b in pairwise(lines)]
    return [lines[0].project(xy_m[0]), *inner, lines[-1].project(xy_m[-1])]


def _intersection(one: Line, other: Line, near_m: Floats) -> Floats:
    """Of two lines; of nearly parallel ones, the place between them that is nearest to where they meet."""
    if abs(math.sin(one.angle_rad(other))) < math.sin(PARALLEL_RAD):
        return (one.project(near_m) + other.project(near_m)) / 2
    across = _cross(other.middle_m - one.middle_m, other.direction)
    crossing: Floats = one.middle_m + across / _cross(one.direction, other.direction) * one.direction
    return crossing


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def snap(segment: Segment, cell_m: float) -> tuple[Move, int]:
    """The nearest of the eight headings, and the length in whole moves of that heading."""
    move = Move(round(-segment.heading_rad / (math.tau / MOVES)) % MOVES)
    return move, round(segment.length_m / (cell_m * math.hypot(move.columns, move.rows)))
