"""The best path an agent has learnt: what every learning curve of the paper shows."""

from __future__ import annotations

from swarm.geometry import Grid
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng


def greedy_path_length(q: QTable, grid: Grid, rng: Rng, cap: int) -> int:
    """Moves from the start to the goal by the greedy action, ties at random.

    A path that has not arrived after `cap` moves counts as `cap`; so does one that runs into a wall,
    since a greedy agent whose table does not change would try the same move again.
    """
    state = grid.start
    for length in range(cap):
        if state == grid.goal:
            return length
        entered = grid.neighbour(state, q.greedy(state, rng))
        state = state if entered is None else entered
    return cap
