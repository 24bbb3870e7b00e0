"""The expert of section 3.4.1."""

from __future__ import annotations

from swarm.geometry import Grid, Move


def expert_move(grid: Grid, state: int) -> Move:
    """The shortest path's next move in an open grid: diagonally to a border of the goal, then along it."""
    column, row = grid.cell(state)
    if column == grid.columns - 1:
        return Move.S
    return Move.E if row == grid.rows - 1 else Move.SE
