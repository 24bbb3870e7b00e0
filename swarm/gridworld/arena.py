"""The two arenas of section 2, each with the shortest path that its expert follows."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import MOVES, Grid, Move


@dataclass(frozen=True)
class Arena:
    """A grid world; `expert_path` is one of its shortest paths, from the start to the goal."""

    name: str
    grid: Grid
    expert_path: tuple[Move, ...]

    @property
    def longest_path(self) -> int:
        """The length at which a greedy path is given up, and as which it then counts: ten times the side.

        It is more than eight times the shortest path, and short enough for the thousands of evaluations
        of a run. A path counts as this long from the start of a run until the goal's value has come
        back to the start cell.
        """
        return 10 * self.grid.columns

    def __hash__(self) -> int:
        return hash(self.name)


@cache
def neighbours(arena: Arena) -> NDArray[np.int16]:
    """The state that each move leads to from each state (states, moves); a blocked move leads nowhere."""
    grid = arena.grid
    entered = [[grid.neighbour(state, move) for move in Move] for state in range(grid.states)]
    return np.array(
        [[state if to is None else to for to in row] for state, row in enumerate(entered)], np.int16
    )


@cache
def ways(arena: Arena) -> NDArray[np.uint8]:
    """The set of moves that lead out of each state, one bit a move (states,)."""
    leads = neighbours(arena) != np.arange(arena.grid.states)[:, np.newaxis]
    return np.packbits(leads, axis=1, bitorder="little").ravel()


@cache
def offsets(arena: Arena) -> NDArray[np.uint64]:
    """What each move adds to the number of the state, modulo 2^64 (moves,)."""
    steps = [move.rows * arena.grid.columns + move.columns for move in Move]
    return np.array(steps, np.int64).view(np.uint64)


@cache
def distances(arena: Arena) -> NDArray[np.int32]:
    """Moves from each state to the goal by a shortest path; -1 where there is none (states,).

    Every move can be taken back, so the search may start from the goal.
    """
    table = neighbours(arena)
    moves = np.full(arena.grid.states, -1, np.int32)
    moves[arena.grid.goal] = 0
    waiting = deque([arena.grid.goal])
    while waiting:
        state = waiting.popleft()
        for entered in table[state]:
            if moves[entered] < 0 and int(state) not in arena.grid.obstacle:
                moves[entered] = moves[state] + 1
                waiting.append(int(entered))
    return moves


def shortest_path(arena: Arena) -> float:
    """Moves from the start to the goal."""
    return float(distances(arena)[arena.grid.start])


def expert_values(arena: Arena, gamma: float) -> NDArray[np.float64]:
    """The Q-table of an agent that has learnt all there is (states, moves): gamma^(moves still to go)."""
    to_go = distances(arena)[neighbours(arena)]
    values = np.where(to_go < 0, 0.0, gamma ** np.maximum(to_go, 0).astype(np.float64))
    values[arena.grid.goal] = 0.0
    return values.reshape(arena.grid.states, MOVES)


def _block(columns: int, first: int, last: int) -> frozenset[int]:
    return frozenset(
        row * columns + column for row in range(first, last + 1) for column in range(first, last + 1)
    )


OPEN_10 = Arena("open-10", Grid(10, 10), (Move.SE,) * 9)
"""Figure 1; the shortest path is unique: nine moves to the south-east."""

OBSTACLE_100 = Arena(
    "obstacle-100",
    Grid(100, 100, _block(100, 40, 59)),
    (Move.SE,) * 39 + (Move.E,) * 20 + (Move.SE,) * 20 + (Move.S,) * 20 + (Move.SE,) * 20,
)
"""Figure 10, with a centred block of 20 x 20 cells, as figure 13 (80 SE, 20 E and 20 S) implies.

A shortest path takes 119 moves, 79 of them SE. The expert's goes round the block by the north-east.
"""
