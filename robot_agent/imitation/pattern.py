"""What was seen of a demonstrator as a pattern of straight segments, wherever they lie and however long."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import TypeVar

from robot_agent.imitation.copying import NoCopy, why_lost
from robot_agent.imitation.demonstration import find_stops, longest_in_sight
from robot_agent.imitation.line_fitting import fit_segments
from robot_agent.imitation.outliers import plausible_trajectory, without_outliers
from robot_agent.imitation.positions import ObservedPosition
from robot_agent.imitation.segments import Segment, Vertex, find_vertices, segments_between
from robot_agent.imitation.smoothing import smooth
from swarm.config.experiment import CopyProfile
from swarm.geometry import wrap_angle_rad

SHORTEST_M = 0.12
"""What counts as a segment: a robot's diameter is 7 cm, and its place is seen to some centimetres."""
STRAIGHT_RAD = math.radians(15)
"""A stop without a turn is none of the pattern's; headings of short segments are seen to 10 degrees."""

Place = tuple[float, float]
T = TypeVar("T")


def seen_pattern(
    positions: Sequence[ObservedPosition], profile: CopyProfile, expected_frames: int
) -> tuple[Segment, ...] | NoCopy:
    """The segments from the first rest of an observation to its last, or why there are none.

    `positions` are those frames in which the demonstrator was seen, out of `expected_frames`.
    """
    if lost := why_lost(len(positions), expected_frames):
        return NoCopy(lost)
    seen = without_outliers(plausible_trajectory(positions))
    observed = longest_in_sight(find_stops(smooth(seen), SHORTEST_M))
    if len(observed.stops) < 2:
        return NoCopy("the demonstrator did not drive from one rest to another in view")
    if profile is CopyProfile.PAPER:
        return fit_segments(observed.seen, SHORTEST_M)
    return segments_between(_corners(find_vertices(observed, SHORTEST_M)))


def _corners(vertices: Sequence[Vertex]) -> list[Vertex]:
    """Without the vertices at which the demonstrator went straight on, the straightest first."""
    corners = list(vertices)
    while len(corners) > 2:
        turns_rad = [abs(segment.turn_rad) for segment in segments_between(corners)[1:]]
        straightest = min(range(len(turns_rad)), key=turns_rad.__getitem__)
        if turns_rad[straightest] > STRAIGHT_RAD:
            break
        del corners[straightest + 1]
    return corners


@dataclass(frozen=True)
class Similarity:
    """How alike two patterns are, each part from 0 to 1; missing segments count as not driven at all."""

    lengths: float
    """1 less the lengths' differences, as a share of the seen length."""
    turns: float
    """1 less the turns' mean difference, as a share of half a turn."""
    corner_error_m: float
    """The mean distance of corners, both patterns laid upon each other at their starts."""

    @property
    def overall(self) -> float:
        return (self.lengths + self.turns) / 2


def similarity(seen: Sequence[Place], driven: Sequence[Place]) -> Similarity:
    """Of a pattern to one that was seen, each given as its corners from the start on.

    ValueError if what was seen has no segment.
    """
    legs, copies = _legs(seen), _legs(driven)
    if not legs:
        raise ValueError("a pattern has at least one segment")
    size = max(len(legs), len(copies))
    nothing = [(0.0, math.pi)]
    pairs = list(zip(_filled(legs, nothing, size), _filled(copies, nothing, size), strict=True))
    length_m = sum(length for length, _ in legs)
    missed_m = sum(abs(length - copied) for (length, _), (copied, _) in pairs)
    turned_rad = [abs(wrap_angle_rad(turn - copied)) for (_, turn), (_, copied) in pairs]
    turns = 1 - sum(turned_rad) / size / math.pi
    return Similarity(max(0.0, 1 - missed_m / length_m), turns, corner_error_m(seen, driven))


def corner_error_m(seen: Sequence[Place], driven: Sequence[Place]) -> float:
    """The mean distance of the corners after the start; a pattern that ends early stays where it ended."""
    size = max(len(seen), len(driven))
    pairs = zip(_filled(seen, seen[-1:], size)[1:], _filled(driven, driven[-1:], size)[1:], strict=True)
    (x_m, y_m), (own_x_m, own_y_m) = seen[0], driven[0]
    away_m = [
        math.hypot(x - x_m - own_x + own_x_m, y - y_m - own_y + own_y_m) for (x, y), (own_x, own_y) in pairs
    ]
    return sum(away_m) / len(away_m)


def corners_of(segments: Sequence[Segment]) -> list[Place]:
    """The corners of a pattern that starts in the origin."""
    return list(accumulate(segments, _after, initial=(0.0, 0.0)))


def _after(corner: Place, segment: Segment) -> Place:
    east_m = segment.length_m * math.cos(segment.heading_rad)
    return corner[0] + east_m, corner[1] + segment.length_m * math.sin(segment.heading_rad)


def _legs(corners: Sequence[Place]) -> list[tuple[float, float]]:
    """Length of each segment, and the turn before it; before the first it is the heading."""
    headings = [math.atan2(end[1] - start[1], end[0] - start[0]) for start, end in pairwise(corners)]
    turns = [heading - before for before, heading in pairwise([0.0, *headings])]
    return list(zip((math.dist(start, end) for start, end in pairwise(corners)), turns, strict=True))


def _filled(items: Sequence[T], filler: Sequence[T], size: int) -> list[T]:
    return [*items, *list(filler) * (size - len(items))]
