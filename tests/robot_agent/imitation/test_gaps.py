"""Out of sight for long, a demonstrator may have moved: only the longest part in sight is read."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.copying import Copy, NoCopy, copy_moves
from robot_agent.imitation.positions import ObservedPosition
from swarm.config.experiment import CopyProfile
from swarm.geometry import Move
from tests.support.demonstrations import COMPARTMENT, Conditions, Demonstration, demonstration

MOVES = (Move.E, Move.SE, Move.S, Move.SW, Move.W, Move.N)
CLEAR = Conditions(range_noise_per_m=0.003, dropped=0.0, outliers=0.0)


def shown() -> Demonstration:
    return demonstration(np.random.default_rng(1), 33, MOVES, CLEAR)


def copied(positions: list[ObservedPosition], expected_frames: int) -> tuple[Move, ...] | str:
    result = copy_moves(positions, CopyProfile.BEST, COMPARTMENT.cell_m, expected_frames)
    return result.reason if isinstance(result, NoCopy) else result.path().moves


def without(seen: Demonstration, from_s: float, to_s: float) -> list[ObservedPosition]:
    began_ns = seen.positions[0].t_ns
    return [each for each in seen.positions if not from_s <= (each.t_ns - began_ns) * 1e-9 < to_s]


def middles_s(seen: Demonstration) -> list[float]:
    """The middle of each of the copied segments."""
    result = copy_moves(seen.positions, CopyProfile.BEST, COMPARTMENT.cell_m, seen.expected_frames)
    assert isinstance(result, Copy)
    began_ns = seen.positions[0].t_ns
    return [(s.t_start_ns + s.t_end_ns - 2 * began_ns) * 0.5e-9 for s in result.segments]


def test_all_is_read_when_a_few_frames_are_missing() -> None:
    seen = shown()
    middle_s = middles_s(seen)[2]
    assert copied(without(seen, middle_s - 0.3, middle_s + 0.3), seen.expected_frames) == MOVES


def test_after_a_long_gap_the_longer_part_is_read() -> None:
    """The second move was not seen: what came before it is the shorter part."""
    seen = shown()
    middle_s = middles_s(seen)[1]
    found = copied(without(seen, middle_s - 0.6, middle_s + 0.6), seen.expected_frames)
    assert found == MOVES[2:]


def test_before_a_long_gap_too() -> None:
    seen = shown()
    middle_s = middles_s(seen)[4]
    found = copied(without(seen, middle_s - 0.6, middle_s + 0.6), seen.expected_frames)
    assert len(found) in (3, 4), "the stop right before the gap may be lost with it"
    assert found == MOVES[: len(found)]


def test_a_single_move_with_its_middle_hidden_is_refused() -> None:
    seen = demonstration(np.random.default_rng(2), 33, (Move.E,), CLEAR)
    began_s = middles_s(seen)[0]
    found = copied(without(seen, began_s - 0.6, began_s + 0.6), seen.expected_frames)
    assert isinstance(found, str), "a reason"
