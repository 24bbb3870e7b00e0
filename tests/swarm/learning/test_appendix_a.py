"""Appendix A: imitation takes no state-action pair's chance of being tried away.

Eq. 9 and 10 are about a visit during which no replay is under way, as at the start of every run; they
are checked with the exact probabilities of the real controller. Three things that the appendix leaves
unsaid are written down as tests: with several paths its p_start is a sum over the paths that begin
with the action; eq. 10 is for a single best action (k best actions share its second term); and an
action that is neither imitated nor greedy keeps (1 - p_start) epsilon / n(A) only, so that outside of
eq. 9's case the proof needs epsilon > 0 besides p_imitate < 1.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from swarm.geometry import MOVES, Move
from swarm.learning.controller import Controller
from swarm.learning.memory import Approach, ImitationMemory, ObservedPath, RememberedPath
from swarm.learning.q_table import QTable
from tests.support.enumeration import EnumeratedRng, probabilities

SLACK = 1e-12
"""Rounding of sums of some dozen probabilities."""
examples = settings(max_examples=60, deadline=None, derandomize=True, database=None)


@dataclass(frozen=True)
class Visit:
    """A state's row of the table, the memory and the settings with which an agent chooses its action."""

    row: tuple[float, ...]
    paths: tuple[tuple[Move, int, int], ...]
    """First move, n_replicated and what is counted of it, for each path"""
    beta: float
    epsilon: float
    approach: Approach

    def memory(self) -> ImitationMemory:
        memory = ImitationMemory(self.beta, self.approach)
        for move, replicated, counted in self.paths:
            path = ObservedPath((move, Move.E, Move.S))
            memory.remembered.append(RememberedPath(path, replicated, counted, counted))
        return memory

    def choose(self, rng: EnumeratedRng) -> int:
        q = QTable(1)
        q.values[0] = list(self.row)
        return Controller(q, self.memory(), self.epsilon, rng).choose(0)

    def p_start(self) -> dict[int, float]:
        """P_choose times p_imitate (eq. 5 and 6), summed over the paths that begin with each action."""
        memory = self.memory()
        total = sum(memory.ratio(path) for path in memory.remembered)
        started: defaultdict[int, float] = defaultdict(float)
        for (move, _, _), path in zip(self.paths, memory.remembered, strict=True):
            started[move] += memory.ratio(path) / total * memory.p_imitate(path)
        return started


counts = st.integers(0, 50).flatmap(lambda n: st.tuples(st.just(n), st.integers(0, n)))
paths = st.tuples(st.sampled_from(Move), counts).map(lambda drawn: (drawn[0], *drawn[1]))
nothing_learnt = st.just((0.0,) * MOVES)
values = st.sampled_from([0.0, 0.1, 0.343, 0.7, 1.0]) | st.floats(0.0, 1.0)
learnt = st.lists(values, min_size=MOVES, max_size=MOVES).map(tuple).filter(any)


def visits(rows: st.SearchStrategy[tuple[float, ...]], most_paths: int = 10) -> st.SearchStrategy[Visit]:
    return st.builds(
        Visit,
        row=rows,
        paths=st.lists(paths, min_size=1, max_size=most_paths).map(tuple),
        beta=st.floats(0.0, 0.99),
        epsilon=st.floats(0.01, 1.0),
        approach=st.sampled_from(Approach),
    )


@given(visits(nothing_learnt | learnt))
@examples
def test_probabilities_of_a_visit_add_up_to_one(visit: Visit) -> None:
    assert sum(probabilities(visit.choose).values()) == pytest.approx(1.0)


@given(visits(nothing_learnt))
@examples
def test_equation_9_holds_where_nothing_is_learnt_yet(visit: Visit) -> None:
    tried, start = probabilities(visit.choose), visit.p_start()
    rest = (1.0 - sum(start.values())) / MOVES
    for action in range(MOVES):
        assert tried[action] >= start[action] + rest - SLACK
        assert tried[action] > 0.0


@given(visits(learnt, most_paths=1))
@examples
def test_equation_10_holds_for_an_imitated_best_action(visit: Visit) -> None:
    tried, best = probabilities(visit.choose), max(visit.row)
    ((action, start),) = visit.p_start().items()
    greedy = visit.row.count(best)
    if visit.row[action] == best:
        kept = start + (1.0 - start) * ((1.0 - visit.epsilon) / greedy + visit.epsilon / MOVES)
        assert tried[action] >= kept - SLACK


@given(visits(learnt))
@examples
def test_every_action_keeps_its_share_of_exploration(visit: Visit) -> None:
    tried, start, best = probabilities(visit.choose), visit.p_start(), max(visit.row)
    accepted = {action: p for action, p in start.items() if visit.row[action] == best}
    share = (1.0 - sum(accepted.values())) * visit.epsilon / MOVES
    for action in range(MOVES):
        assert tried[action] >= accepted.get(action, 0.0) + share - SLACK
        assert tried[action] > 0.0


def test_rejected_path_leaves_plain_exploration() -> None:
    visit = Visit((0.0, 0.7, *(0.0,) * 6), ((Move.E, 0, 0),), 0.5, 0.2, Approach.FIXED)
    tried = probabilities(visit.choose)
    assert tried[Move.E] == pytest.approx(0.2 / MOVES)
    assert tried[Move.SE] == pytest.approx(0.8 + 0.2 / MOVES)


def test_certain_imitation_would_starve_the_other_actions() -> None:
    visit = Visit((0.0,) * MOVES, ((Move.E, 0, 0),), 1.0, 0.2, Approach.FIXED)
    assert probabilities(visit.choose) == {int(Move.E): 1.0}
