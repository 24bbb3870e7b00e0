"""Appendix A: imitation takes no state-action pair's chance of being tried away.

The chances of eq. 9 and 10 are worked out from the paper's equations alone (`tests/support/appendix_a.py`)
and compared with the exact ones of the real controller, at the start of a replay and within one; then
fourteen programs that are wrong in one place each have to be told from it.

What the appendix leaves open: with several paths its p_start is a sum over the paths that begin with the
action; eq. 10 is for a single best action (k best actions share its second term); an action that is neither
imitated nor greedy keeps (1 - p_start) epsilon / n(A) only, so that the proof needs epsilon > 0 besides
p_imitate < 1. Within a replay nothing is explored: the proof speaks of the states where a replay begins. And
eq. 8 asks for learning rates whose squares have a finite sum, which the constant 0.2 has not: visits do not
end, but values go on moving.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swarm.geometry import MOVES, Move
from swarm.learning.controller import Controller, Outcome, Replay
from swarm.learning.memory import ImitationMemory, RememberedPath
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng
from tests.support.appendix_a import (
    PATH_MOVES,
    Memory,
    Program,
    Remembered,
    Visit,
    check_end,
    check_rejection,
    check_start,
    check_within,
    expected_start,
)

examples = settings(max_examples=60, deadline=None, derandomize=True, database=None)

counts = st.integers(0, 50).flatmap(lambda n: st.tuples(st.just(n), st.integers(0, n)))
moves = st.lists(st.sampled_from(Move), min_size=PATH_MOVES, max_size=PATH_MOVES).map(tuple)
paths = st.builds(lambda path, count: Remembered(path, *count), moves, counts)
values = st.sampled_from([0.0, 0.1, 0.343, 0.7, 1.0]) | st.floats(0.0, 1.0)
rows = st.just((0.0,) * MOVES) | st.lists(values, min_size=MOVES, max_size=MOVES).map(tuple)


def visits(most_paths: int = 10) -> st.SearchStrategy[Visit]:
    return st.builds(
        Visit,
        row=rows,
        paths=st.lists(paths, min_size=1, max_size=most_paths).map(tuple),
        beta=st.floats(0.0, 0.99),
        epsilon=st.floats(0.01, 1.0),
    )


@given(visits())
@examples
def test_the_start_of_a_visit_has_the_chances_of_equations_9_and_10(visit: Visit) -> None:
    check_start(visit, Controller, ImitationMemory)


@given(visits(most_paths=1), st.integers(1, PATH_MOVES - 1))
@examples
def test_a_replay_goes_on_while_no_action_is_better(visit: Visit, place: int) -> None:
    check_within(visit, place, Controller, ImitationMemory)


@given(visits())
@examples
def test_every_action_keeps_a_share_of_exploration(visit: Visit) -> None:
    assert min(expected_start(visit)) >= (1 - visit.beta) * visit.epsilon / MOVES - 1e-12


def test_certain_imitation_would_starve_the_other_actions() -> None:
    visit = Visit((0.0,) * MOVES, (Remembered((Move.E,) * PATH_MOVES, 0, 0),), 1.0, 0.2)
    check_start(visit, Controller, ImitationMemory)
    assert expected_start(visit) == [1.0, *(0.0,) * (MOVES - 1)]


UNTRIED = Remembered((Move.E, Move.E, Move.S), 0, 0)
USED = Remembered((Move.E, Move.SE, Move.S), 9, 4)
OTHER = Remembered((Move.N, Move.E, Move.S), 3, 0)
NOTHING = (0.0,) * MOVES
EAST_IS_BEST = (0.7, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
TIED = (0.7, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def check(program: Program, memory_of: Memory) -> None:
    """All of the appendix, for a program: a few visits that tell it apart from any other."""
    for paths in ((UNTRIED,), (USED,), (UNTRIED, USED, OTHER)):
        for row in (NOTHING, EAST_IS_BEST, TIED, EAST_IS_BEST[::-1]):
            check_start(Visit(row, paths, 0.5, 0.2), program, memory_of)
    for row in (NOTHING, EAST_IS_BEST, TIED):
        for place in (1, 2):
            check_within(Visit(row, (USED,), 0.5, 0.2), place, program, memory_of)
    visit = Visit(NOTHING, (UNTRIED,), 0.5, 0.2)
    for ending in ({"blocked": True}, {"arrived": True}):
        for change in (0.0, 0.1):
            check_end(visit, ending, change, program, memory_of)
    check_rejection(Visit(EAST_IS_BEST, (USED,), 0.5, 0.2), program, memory_of)


def test_the_real_program_passes() -> None:
    check(Controller, ImitationMemory)


class NoOneAdded(ImitationMemory):
    def ratio(self, remembered: RememberedPath) -> float:
        return (remembered.n_q_plus + 1) / (remembered.n_replicated + 2)


class SquaredRatio(ImitationMemory):
    def ratio(self, remembered: RememberedPath) -> float:
        return super().ratio(remembered) ** 2


class UniformChoice(ImitationMemory):
    def choose(self, rng: Rng) -> RememberedPath:
        return self.remembered[int(rng.integers(len(self.remembered)))]


class BetaAlone(ImitationMemory):
    def p_imitate(self, remembered: RememberedPath) -> float:  # noqa: ARG002
        return self.beta


class UncheckedStart(Controller):
    def choose(self, state: int) -> int:
        begins = self.replay is None
        if begins:
            self.replay = self._started()
        if self.replay is None:
            return self._epsilon_greedy(state)
        if begins:
            return self.replay.remembered.path.action(0, state, self.rng)
        return super().choose(state)


class UncheckedWithin(Controller):
    def choose(self, state: int) -> int:
        if self.replay is None:
            return super().choose(state)
        self.replay.index += 1
        return self.replay.remembered.path.action(self.replay.index, state, self.rng)


class CheckedLast(Controller):
    def __init__(self, q: QTable, memory: ImitationMemory, epsilon: float, rng: Rng) -> None:
        super().__init__(q, memory, epsilon, rng, checks_last=True)


class StrictlyBest(Controller):
    """Rejects an action that only ties with the best."""

    def choose(self, state: int) -> int:
        chosen = super().choose(state)
        if self.replay and self.q.best_actions(state) != [chosen]:
            self._end(Outcome.REJECTED, executed=self.replay.index)
            return self._epsilon_greedy(state)
        return chosen


class DrivesOnAtWalls(Controller):
    @staticmethod
    def _outcome(replay: Replay, *, blocked: bool, arrived: bool) -> Outcome | None:  # noqa: ARG004
        return Controller._outcome(replay, blocked=False, arrived=arrived)


class GoesOnInTheGoal(Controller):
    @staticmethod
    def _outcome(replay: Replay, *, blocked: bool, arrived: bool) -> Outcome | None:  # noqa: ARG004
        return Controller._outcome(replay, blocked=blocked, arrived=False)


class GreedyAfterRejection(Controller):
    def _end(self, outcome: Outcome, executed: int) -> None:
        super()._end(outcome, executed)
        if outcome is Outcome.REJECTED:
            self.epsilon = 0.0


class FirstOfTies(Controller):
    def _epsilon_greedy(self, state: int) -> int:
        explores = self.epsilon > self.rng.random()
        return int(self.rng.integers(MOVES)) if explores else self.q.best_actions(state)[0]


class ForgetsRejections(Controller):
    def _end(self, outcome: Outcome, executed: int) -> None:
        if outcome is Outcome.REJECTED:
            self.replay = None
        else:
            super()._end(outcome, executed)


class CountsNoChange(Controller):
    def _end(self, outcome: Outcome, executed: int) -> None:
        assert self.replay is not None
        self.replay.q_change += 1e-9
        super()._end(outcome, executed)


WRONG: dict[str, tuple[Program, Memory]] = {
    "R is not eq. 4": (Controller, NoOneAdded),
    "R is squared": (Controller, SquaredRatio),
    "paths are chosen evenly, not by eq. 5": (Controller, UniformChoice),
    "p_imitate is beta, not eq. 6": (Controller, BetaAlone),
    "no Q check of the first action": (UncheckedStart, ImitationMemory),
    "no Q check after the first action": (UncheckedWithin, ImitationMemory),
    "a Q check of the last action": (CheckedLast, ImitationMemory),
    "an action as good as another is rejected": (StrictlyBest, ImitationMemory),
    "a replay goes on at a wall": (DrivesOnAtWalls, ImitationMemory),
    "a replay goes on in the goal": (GoesOnInTheGoal, ImitationMemory),
    "no exploration after a rejection": (GreedyAfterRejection, ImitationMemory),
    "the first of tied actions is taken": (FirstOfTies, ImitationMemory),
    "a rejected replay is not counted": (ForgetsRejections, ImitationMemory),
    "no change counts as an increase": (CountsNoChange, ImitationMemory),
}


@pytest.mark.parametrize(("program", "memory_of"), WRONG.values(), ids=WRONG)
def test_a_program_that_is_wrong_in_one_place_is_found(program: Program, memory_of: Memory) -> None:
    with pytest.raises(AssertionError):
        check(program, memory_of)
