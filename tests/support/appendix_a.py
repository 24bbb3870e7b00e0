"""Appendix A's chances, written from the paper alone: what a controller has to do, in exact probabilities.

Nothing here asks the code under test for a ratio or a probability: eq. 4 to 6, 9 and 10 are worked out from
counts and Q values.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from swarm.geometry import MOVES, Move
from swarm.learning.controller import Controller, Replay
from swarm.learning.memory import ImitationMemory, ObservedPath, RememberedPath
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng
from tests.support.enumeration import EnumeratedRng, probabilities

Program = Callable[[QTable, ImitationMemory, float, Rng], Controller]
"""A controller with what it works on; the right one is `Controller`."""
Memory = Callable[[float], ImitationMemory]
"""A memory of a beta."""

Row = tuple[float, ...]
PATH_MOVES = 3


@dataclass(frozen=True)
class Remembered:
    """A path in the memory, with its counts."""

    moves: tuple[Move, ...]
    replicated: int
    raised: int


@dataclass(frozen=True)
class Visit:
    """A state's row of the table, the memory and the settings with which an agent chooses its action."""

    row: Row
    paths: tuple[Remembered, ...]
    beta: float
    epsilon: float


def epsilon_greedy(row: Row, epsilon: float) -> list[float]:
    """The chance of each action: greedy ones share 1 - epsilon, and all of them epsilon."""
    best = max(row)
    share = (1 - epsilon) / row.count(best)
    return [epsilon / MOVES + (share if value == best else 0.0) for value in row]


def expected_start(visit: Visit) -> list[float]:
    """Eq. 9 and 10 for any memory: the chance of each action where no replay is under way."""
    ratios = [(path.raised + 1) / (path.replicated + 1) for path in visit.paths]
    started = [ratio / sum(ratios) * visit.beta * ratio for ratio in ratios]
    accepted = [0.0] * MOVES
    for path, chance in zip(visit.paths, started, strict=True):
        if visit.row[path.moves[0]] == max(visit.row):
            accepted[path.moves[0]] += chance
    rest = 1 - sum(accepted)
    own = epsilon_greedy(visit.row, visit.epsilon)
    return [chance + rest * alone for chance, alone in zip(accepted, own, strict=True)]


def expected_within(visit: Visit, place: int) -> list[float]:
    """The same at a later place of a replay: certain unless it is rejected; the last is not checked."""
    (path,) = visit.paths
    action = path.moves[place]
    last = place == len(path.moves) - 1
    if last or visit.row[action] == max(visit.row):
        return [float(move == action) for move in range(MOVES)]
    return epsilon_greedy(visit.row, visit.epsilon)


def controller(visit: Visit, program: Program, memory_of: Memory, rng: Rng, rows: int = 1) -> Controller:
    """The program under test before a visit of state 0; all `rows` states have the visit's values."""
    memory = memory_of(visit.beta)
    for number, path in enumerate(visit.paths, 1):
        observed = ObservedPath(path.moves)
        memory.remembered.append(RememberedPath(observed, path.replicated, path.raised, path.raised, number))
    q = QTable(rows)
    q.values = [list(visit.row) for _ in range(rows)]
    return program(q, memory, visit.epsilon, rng)


def check_start(visit: Visit, program: Program, memory_of: Memory) -> None:
    """AssertionError if the first action of a visit has not the chances of eq. 9 and 10."""
    _compare(lambda rng: controller(visit, program, memory_of, rng).choose(0), expected_start(visit))


def check_within(visit: Visit, place: int, program: Program, memory_of: Memory) -> None:
    """AssertionError if a later action of a replay has not: the Q check comes at every step but the last."""

    def play(rng: EnumeratedRng) -> int:
        made = replaying(visit, place, program, memory_of, rng)
        return made.choose(0)

    _compare(play, expected_within(visit, place))


def check_end(
    visit: Visit, ending: dict[str, bool], change: float, program: Program, memory_of: Memory
) -> None:
    """AssertionError unless a wall or the goal ends a replay, which then counts into R (eq. 4)."""
    made = replaying(visit, 1, program, memory_of, EnumeratedRng(()))
    (remembered,) = made.memory.remembered
    before = remembered.n_replicated, remembered.n_q_plus
    made.choose(0)
    made.learn(0, int(visit.paths[0].moves[1]), 5 * change, 0, 0.0, **ending)
    assert made.replay is None, "the replay goes on"
    assert remembered.n_replicated == before[0] + 1
    assert remembered.n_q_plus == before[1] + (change > 0)


def check_rejection(visit: Visit, program: Program, memory_of: Memory) -> None:
    """AssertionError unless a rejected replay is over and counted."""
    made = replaying(visit, 1, program, memory_of, EnumeratedRng(()))
    (remembered,) = made.memory.remembered
    before = remembered.n_replicated
    made.choose(0)
    assert made.replay is None, "the rejected replay goes on"
    assert remembered.n_replicated == before + 1


def replaying(visit: Visit, place: int, program: Program, memory_of: Memory, rng: Rng) -> Controller:
    """A program in the middle of its only path, about to choose the action at `place`."""
    made = controller(visit, program, memory_of, rng)
    made.replay = Replay(made.memory.remembered[0], place - 1)
    return made


def _compare(play: Callable[[EnumeratedRng], int], expected: list[float]) -> None:
    found = probabilities(play)
    assert [found.get(action, 0.0) for action in range(MOVES)] == pytest.approx(expected, abs=1e-12)
