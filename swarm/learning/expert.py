"""The expert of section 3.4.1, and one who does not know better."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import cache

from swarm.geometry import Grid, Move

Plan = Callable[[Grid, int], Move]
"""The move of a teacher that stands in a state."""


def expert_move(grid: Grid, state: int) -> Move:
    """A shortest path's next move, on any grid: to the south-east where that is one."""
    to_go = _moves_to_goal(grid)
    return min(PREFERRED, key=lambda move: to_go[_entered(grid, state, move)])


def edge_move(grid: Grid, state: int) -> Move:
    """A teacher that knows no diagonal: along the north wall to the east, then along the east wall."""
    column, _ = grid.cell(state)
    return Move.S if column == grid.columns - 1 else Move.E


PREFERRED = (Move.SE, Move.S, Move.E, Move.SW, Move.NE, Move.W, Move.N, Move.NW)
"""In an open grid: diagonally to a border of the goal, then along it."""


def _entered(grid: Grid, state: int, move: Move) -> int:
    entered = grid.neighbour(state, move)
    return state if entered is None else entered


@cache
def _moves_to_goal(grid: Grid) -> dict[int, int]:
    """From each state that the goal can be reached from; every move can be taken back, so from the goal."""
    moves, waiting = {grid.goal: 0}, deque([grid.goal])
    while waiting:
        state = waiting.popleft()
        for move in Move:
            entered = grid.neighbour(state, move)
            if entered is not None and entered not in moves:
                moves[entered] = moves[state] + 1
                waiting.append(entered)
    return moves
