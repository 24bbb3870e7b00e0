"""The expert's way to the goal."""

from __future__ import annotations

import pytest

from swarm.geometry import Grid
from swarm.learning.expert import expert_move


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
