"""From what was seen of a demonstration to the list of moves that will be imitated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robot_agent.imitation.compass_moves import read_moves
from robot_agent.imitation.demonstration import Place, find_stops, longest_demonstration, longest_in_sight
from robot_agent.imitation.line_fitting import fit_segments, snap
from robot_agent.imitation.outliers import plausible_trajectory, without_outliers
from robot_agent.imitation.positions import ObservedPosition
from robot_agent.imitation.segments import Segment, find_vertices, segments_between
from robot_agent.imitation.smoothing import smooth
from robot_agent.imitation.trajectory import SmoothedTrajectory, Stop
from swarm.config.experiment import CopyProfile
from swarm.geometry import Move
from swarm.learning.memory import ObservedPath

MOST_POSITIONS = 5_000
"""A quarter of an hour at five frames a second; more is a fault, and would keep the robot from its work."""
REST_KEPT = 2
"""Positions of the first and the last rest to which lines are fitted: a long rest leaves a cloud of them."""
MOST_LOST = 0.3
"""Larger a share of frames without the demonstrator, and nothing is copied. Chosen: a frame or
two lost in every move still show them all (tests/robot_agent/imitation/test_copying.py loses a quarter)."""


@dataclass(frozen=True)
class CopiedMove:
    """A move, and by how much chi2 the best list beats the best one that reads it otherwise.

    The profile `paper` weighs nothing, so its confidence is 0.
    """

    move: Move
    confidence: float


@dataclass(frozen=True)
class Copy:
    """What the observer believes that the demonstrator did."""

    moves: tuple[CopiedMove, ...]
    segments: tuple[Segment, ...]
    smoothed: tuple[ObservedPosition, ...]
    """The whole observation, not only the demonstration; the profile `paper` does not smooth."""

    def path(self) -> ObservedPath:
        return ObservedPath(tuple(copied.move for copied in self.moves))


@dataclass(frozen=True)
class NoCopy:
    """Nothing is learnt from this observation."""

    reason: str


def copy_moves(
    positions: Sequence[ObservedPosition],
    profile: CopyProfile,
    cell_m: float,
    expected_frames: int,
    start_m: Place | None = None,
) -> Copy | NoCopy:
    """The moves of the demonstration within an observation, or why there are none.

    `positions` are those frames in which the demonstrator was seen, out of `expected_frames`; a position
    that its neighbours contradict counts as a lost frame. The drive back to the start is left out, and so is
    a move that the observation's beginning or end cuts; of a demonstration that was out of sight for a while
    the longest part in sight counts. `start_m` is the middle of the start cell, where the
    drive back ends: if it is known, the drive is told from a fast demonstration more surely.
    """
    if len(positions) > MOST_POSITIONS:
        return NoCopy(
            f"{len(positions)} positions are more than {MOST_POSITIONS}: observe for a shorter time"
        )
    seen = without_outliers(plausible_trajectory(positions))
    if lost := _lost(len(seen), expected_frames):
        return NoCopy(lost)
    observed = find_stops(smooth(seen), cell_m)
    shown = longest_demonstration(observed, cell_m, start_m)
    if len(shown.stops) < 2:
        return NoCopy(_no_demonstration(observed.stops))
    shown = longest_in_sight(shown)
    if len(shown.stops) < 2:
        return NoCopy("the demonstrator was out of sight for so long that moves may have been missed")
    copied = _READERS[profile](shown, cell_m)
    return copied if copied.moves else NoCopy("the demonstrator moved, but by less than a cell")


def _lost(seen: int, expected_frames: int) -> str | None:
    if expected_frames < 1:
        return "no frames were taken"
    if seen == 0:
        return f"the demonstrator was not seen in any of {expected_frames} frames"
    if seen < (1 - MOST_LOST) * expected_frames:
        return f"the demonstrator was lost in {expected_frames - seen} of {expected_frames} frames"
    return None


def _no_demonstration(stops: Sequence[Stop]) -> str:
    if not stops:
        return "the demonstrator never stood still, so no move begins or ends in view"
    if len(stops) == 1:
        return "the demonstrator stood still, or moved only while entering or leaving the observation"
    return "the demonstrator only drove back to its start"


def _copy_by_stops(shown: SmoothedTrajectory, cell_m: float) -> Copy:
    """The moves that explain all the stops together."""
    vertices = find_vertices(shown, cell_m)
    stretches = read_moves(vertices, cell_m)
    moves = [
        CopiedMove(stretch.move, stretch.confidence) for stretch in stretches for _ in range(stretch.cells)
    ]
    corners = [vertices[0], *(vertices[stretch.vertex] for stretch in stretches)]
    return Copy(tuple(moves), segments_between(corners), shown.positions())


def _copy_by_lines(shown: SmoothedTrajectory, cell_m: float) -> Copy:
    """Section 3.2 of the paper: regression line fitting, to the positions as they were seen."""
    first, last = shown.stops[0], shown.stops[-1]
    within = np.zeros(len(shown), dtype=np.bool_)
    within[max(first.first, first.last - REST_KEPT) : last.first + REST_KEPT + 1] = True
    segments = fit_segments(shown.seen.where(within), cell_m)
    snapped = [snap(segment, cell_m) for segment in segments]
    moves = [CopiedMove(move, 0.0) for move, cells in snapped for _ in range(cells)]
    return Copy(tuple(moves), segments, shown.seen.positions())


_READERS = {CopyProfile.BEST: _copy_by_stops, CopyProfile.PAPER: _copy_by_lines}
