"""The best path an agent has learnt: what every learning curve of the paper shows."""

from __future__ import annotations

from dataclasses import dataclass

from swarm.geometry import MOVES, Grid
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng


@dataclass(frozen=True)
class GreedyPath:
    """Its length, the cap if it has not arrived; and whether it passed a cell in which nothing is learnt."""

    length: int
    by_luck: bool


def greedy_path_length(q: QTable, grid: Grid, rng: Rng, cap: int) -> int:
    """Moves from the start to the goal by the greedy action, ties at random."""
    return greedy_path(q, grid, rng, cap).length


def greedy_path(q: QTable, grid: Grid, rng: Rng, cap: int) -> GreedyPath:
    """The path from the start by the greedy action, ties at random.

    A path that has not arrived after `cap` moves counts as `cap`; so does one that runs into a wall,
    since a greedy agent whose table does not change would try the same move again. Where all values of a cell
    are equal the path goes on by luck.
    """
    state, luck = grid.start, False
    for length in range(cap):
        if state == grid.goal:
            return GreedyPath(length, luck)
        luck |= len(q.best_actions(state)) == MOVES
        entered = grid.neighbour(state, q.greedy(state, rng))
        state = state if entered is None else entered
    return GreedyPath(cap, luck)
