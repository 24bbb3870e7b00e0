"""The expert's way to the goal."""

from __future__ import annotations

import pytest

from swarm.geometry import Grid
from swarm.learning.expert import edge_move, expert_move


@pytest.mark.parametrize("grid", [Grid(10, 10), Grid(5, 8), Grid(7, 3)])
def test_it_takes_the_fewest_moves_from_every_cell(grid: Grid) -> None:
    """Also from beside its path, where somebody may have set it down."""
    for start in range(grid.goal):
        state, moves = start, 0
        while state != grid.goal:
            entered = grid.neighbour(state, expert_move(grid, state))
            assert entered is not None, "a wall"
            state, moves = entered, moves + 1
        column, row = grid.cell(start)
        assert moves == max(grid.columns - 1 - column, grid.rows - 1 - row)


def test_it_plans_round_an_obstacle() -> None:
    grid = Grid(10, 10, frozenset(row * 10 + column for row in range(3, 7) for column in range(3, 7)))
    state, moves = grid.start, 0
    while state != grid.goal:
        entered = grid.neighbour(state, expert_move(grid, state))
        assert entered is not None, "a wall or the obstacle"
        state, moves = entered, moves + 1
    assert moves == 13


def test_one_who_knows_no_diagonal_takes_twice_as_many() -> None:
    grid = Grid(10, 10)
    state, moves = grid.start, 0
    while state != grid.goal:
        entered = grid.neighbour(state, edge_move(grid, state))
        assert entered is not None
        state, moves = entered, moves + 1
    assert moves == 18
