"""Corners to compass moves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from robot_agent.imitation.compass_moves import read_moves
from robot_agent.imitation.segments import Vertex
from swarm.geometry import Move

CELL_M = 0.12


def vertices(
    moves: Sequence[tuple[Move, float]], sd_m: float, rng: np.random.Generator | None = None
) -> list[Vertex]:
    """Where a demonstrator stops after each (move, cells), seen with an error if a generator is given."""
    steps = [
        (0.503, 0.517),
        *((cells * move.columns * CELL_M, -cells * move.rows * CELL_M) for move, cells in moves),
    ]
    places_m = np.cumsum(steps, axis=0)
    if rng is not None:
        places_m += rng.normal(0.0, sd_m, places_m.shape)
    return [Vertex(place_m, sd_m**2 * np.eye(2), 0, 0) for place_m in places_m]


def names(found: Sequence[Vertex]) -> list[str]:
    return [stretch.move.name for stretch in read_moves(found, CELL_M) for _ in range(stretch.cells)]


@pytest.mark.parametrize("move", list(Move))
def test_every_heading_and_length(move: Move) -> None:
    for cells in (1, 2, 5):
        assert names(vertices([(move, cells)], 0.01)) == [move.name] * cells


def test_stops_between_equal_moves_are_kept_apart() -> None:
    assert names(vertices([(Move.SE, 1)] * 5, 0.02)) == ["SE"] * 5


def test_a_false_stop_between_two_cells_is_skipped() -> None:
    assert names(vertices([(Move.E, 1), (Move.NE, 0.45), (Move.NE, 0.55), (Move.S, 1)], 0.006)) == [
        "E",
        "NE",
        "S",
    ]


def test_a_stop_that_was_seen_twice_is_one() -> None:
    assert names(vertices([(Move.E, 1), (Move.E, 0.05), (Move.S, 1)], 0.01)) == ["E", "S"]


def test_all_corners_together_beat_each_length_rounded_alone() -> None:
    """With errors of a third of a cell, rounding every displacement by itself goes wrong more often."""
    rng = np.random.default_rng(3)
    moves = [(Move.E, 1.0), (Move.N, 1.0), (Move.W, 1.0), (Move.S, 1.0), (Move.E, 1.0)]
    together = alone = 0
    for _ in range(200):
        found = vertices(moves, 0.025, rng)
        truth = [move.name for move, _ in moves]
        together += names(found) == truth
        alone += [name for i in range(5) for name in names(found[i : i + 2])] == truth
    assert together > alone + 10


def test_confidence_falls_with_noise_and_with_ambiguity() -> None:
    clear, noisy = (read_moves(vertices([(Move.E, 1)], sd_m), CELL_M)[0].confidence for sd_m in (0.01, 0.05))
    between = read_moves(vertices([(Move.E, 1.45)], 0.05), CELL_M)[0].confidence
    assert clear > noisy > between > 0


def test_a_constant_error_of_the_heading_is_borne() -> None:
    turn_rad = math.radians(5)
    turn = np.array([[math.cos(turn_rad), -math.sin(turn_rad)], [math.sin(turn_rad), math.cos(turn_rad)]])
    moves = [(Move.SE, 1.0), (Move.E, 1.0), (Move.N, 1.0), (Move.NW, 1.0), (Move.SW, 1.0)]
    turned = [Vertex(turn @ v.xy_m, v.covariance_m2, 0, 0) for v in vertices(moves, 0.01)]
    assert names(turned) == [move.name for move, _ in moves]


def test_fewer_than_two_corners_are_no_move() -> None:
    assert read_moves([], CELL_M) == []
    assert read_moves(vertices([], 0.01), CELL_M) == []
