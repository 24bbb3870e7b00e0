"""The compiled engine is the plain controller, bit for bit, and its runs are reproducible."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from swarm.geometry import Move
from swarm.gridworld.arena import OBSTACLE_100, OPEN_10
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    CopyEachOther,
    CopyExperienced,
    CopyExpert,
    GivenPaths,
    NoTeacher,
    Precision,
    Teacher,
)
from swarm.gridworld.simulation import Simulation, simulate
from swarm.gridworld.state import AgentArrays
from swarm.learning.controller import QIncrease
from swarm.learning.memory import Approach, ObservedPath
from tests.support.plain_gridworld import PlainAgent, PlainSimulation

TOWARDS = GivenPaths((ObservedPath((Move.SE,) * 5),))
ALONG = GivenPaths((ObservedPath((Move.E,) * 5),))
EIGHT = GivenPaths(tuple(ObservedPath((move,) * 4) for move in Move))
MIXED = GivenPaths((ObservedPath((Move.SE,)), ObservedPath((Move.N, Move.SE, Move.SE))))
TEACHERS: dict[str, Teacher] = {
    "no imitation": NoTeacher(),
    "towards the goal": TOWARDS,
    "away from it": ALONG,
    "eight paths": EIGHT,
    "a path of one move": MIXED,
    "a pair that learns alone": NoTeacher(learners=2),
    "expert": CopyExpert(moves=4, every=3),
    "expert at once": CopyExpert(moves=4, every=3, copies_at_once=True),
    "experienced": CopyExperienced(moves=4, every=3, goal_reachings=20, copies_at_once=True),
    "each other": CopyEachOther(moves=4, every=3),
    "more moves than a run has": CopyEachOther(moves=30, every=2),
    "access to the expert": AccessExpert(moves=6),
    "access to each other": AccessEachOther(moves=6),
}


def condition(teacher: Teacher, approach: Approach = Approach.AVERAGE_Q, **changes: object) -> Condition:
    base = Condition(
        "case", OPEN_10, teacher, epsilon=0.3, approach=approach, capacity=8, steps=4_000, evaluate_every=10
    )
    return replace(base, **changes)  # type: ignore[arg-type]


def assert_same(agent: AgentArrays, plain: PlainAgent) -> None:
    """Place, table, memory, replay in progress and the next random number are all the same."""
    controller = plain.controller
    assert agent.state[0] == plain.state
    assert agent.arrivals[0] == plain.arrivals
    assert np.array_equal(agent.q.reshape(-1, 8), controller.q.values)
    assert agent.stream[0] == controller.rng.word  # type: ignore[attr-defined]
    remembered = controller.memory.remembered
    assert agent.remembered[0] == len(remembered)
    assert [controller.memory.ratio(path) for path in remembered] == agent.ratios[: len(remembered)].tolist()
    assert [path.n_replicated for path in remembered] == agent.n_replicated[: len(remembered)].tolist()
    for stored, length, path in zip(agent.paths, agent.lengths, remembered, strict=False):
        if isinstance(path.path, ObservedPath):
            assert stored[:length].tolist() == list(path.path.moves)
    if controller.replay is None:
        assert agent.replay[0] == -1
    else:
        assert agent.q_change[0] == controller.replay.q_change
        assert agent.replay_index[0] == controller.replay.index


@pytest.mark.parametrize("approach", Approach)
@pytest.mark.parametrize("teacher", TEACHERS.values(), ids=TEACHERS)
def test_engine_equals_the_plain_controller(teacher: Teacher, approach: Approach) -> None:
    case = condition(teacher, approach)
    plain, compiled = PlainSimulation(case, 7, 1), Simulation(case, 7, 1)
    for _ in range(4_000):
        plain.step()
    trace = compiled.trace(compiled.advance())
    assert_same(compiled.one.agent, plain.one)
    assert_same(compiled.two.agent, plain.two) if not isinstance(teacher, AccessExpert) else None
    learners = [plain.one, plain.two][: case.learners]
    assert trace.best_path_length.tolist() == [learner.lengths for learner in learners]


READINGS: dict[str, dict[str, object]] = {
    "stored": {"increase": QIncrease.STORED},
    "average": {"increase": QIncrease.AVERAGE},
    "single": {"precision": Precision.SINGLE},
    "single and average": {"precision": Precision.SINGLE, "increase": QIncrease.AVERAGE},
    "the last action checked": {"checks_last": True},
}


@pytest.mark.parametrize("changes", READINGS.values(), ids=READINGS)
def test_engine_equals_the_plain_controller_under_every_reading(changes: dict[str, object]) -> None:
    case = replace(condition(CopyEachOther(moves=4, every=3)), **changes)  # type: ignore[arg-type]
    plain, compiled = PlainSimulation(case, 7, 1), Simulation(case, 7, 1)
    for _ in range(4_000):
        plain.step()
    compiled.advance()
    assert_same(compiled.one.agent, plain.one)
    assert_same(compiled.two.agent, plain.two)


def test_a_path_through_unlearnt_cells_has_not_arrived() -> None:
    lucky, strict = (
        simulate(condition(NoTeacher(), counts_luck=luck, evaluate_every=1), 1, 0).best_path_length[0]
        for luck in (True, False)
    )
    differs = lucky != strict
    assert differs.any()
    assert np.all(strict[differs] == OPEN_10.longest_path)
    assert np.array_equal(lucky[-100:], strict[-100:])


def test_later_evaluations_come_seldom() -> None:
    often = simulate(condition(NoTeacher()), 1, 0)
    case = condition(NoTeacher(), points=100, later_every=500, later_points=4)
    seldom = simulate(case, 1, 0)
    assert case.evaluated_steps(4_000).tolist() == [*range(10, 1001, 10), 1500, 2000, 2500, 3000]
    assert seldom.best_path_length.shape == (1, 104)
    assert np.array_equal(seldom.best_path_length[0, :100], often.best_path_length[0, :100])


def test_what_has_happened_is_tallied() -> None:
    copied, tried, *_ = simulate(condition(CopyExpert(moves=4, every=3)), 1, 0).tally[0]
    assert copied >= tried > 8
    *_, suggested, at_random = simulate(condition(AccessEachOther(moves=6)), 1, 0).tally[0]
    assert suggested > at_random > 0


@pytest.mark.parametrize("teacher", TEACHERS.values(), ids=TEACHERS)
def test_every_decision_is_the_same(teacher: Teacher) -> None:
    case = condition(teacher)
    plain, compiled = PlainSimulation(case, 3, 0), Simulation(case, 3, 0)
    for _ in range(400):
        plain.step()
        compiled.advance(steps=1)
        assert_same(compiled.one.agent, plain.one)


def test_memory_forgets_as_the_plain_one_does() -> None:
    case = condition(CopyEachOther(moves=4, every=1), capacity=3)
    plain, compiled = PlainSimulation(case, 5, 0), Simulation(case, 5, 0)
    for _ in range(4_000):
        plain.step()
    compiled.advance()
    assert plain.one.arrivals > 4 * case.capacity
    assert_same(compiled.one.agent, plain.one)
    assert_same(compiled.two.agent, plain.two)


def test_engine_equals_the_plain_controller_round_the_obstacle() -> None:
    paths = GivenPaths(tuple(ObservedPath((move,) * 20) for move in Move))
    case = condition(paths, arena=OBSTACLE_100, epsilon=0.5, steps=150_000, evaluate_every=50_000)
    plain, compiled = PlainSimulation(case, 1, 0), Simulation(case, 1, 0)
    for _ in range(150_000):
        plain.step()
    trace = compiled.trace(compiled.advance())
    assert_same(compiled.one.agent, plain.one)
    assert trace.best_path_length.tolist() == [plain.one.lengths]


def test_greedy_sets_are_the_tables_maxima() -> None:
    compiled = Simulation(condition(EIGHT), 11, 0)
    compiled.advance()
    table = compiled.one.agent.q.reshape(-1, 8)
    assert np.array_equal(compiled.one.agent.best, table.max(axis=1))
    sets = ((table == table.max(axis=1, keepdims=True)) << np.arange(8)).sum(axis=1)
    assert np.array_equal(compiled.one.agent.greedy, sets)


def test_evaluation_does_not_disturb_learning() -> None:
    often, seldom = (condition(EIGHT, evaluate_every=every) for every in (1, 1_000))
    one, other = Simulation(often, 2, 0), Simulation(seldom, 2, 0)
    one.advance()
    other.advance()
    assert np.array_equal(one.one.agent.q, other.one.agent.q)


def test_same_seed_gives_the_same_trace_on_any_thread() -> None:
    case = condition(CopyEachOther(moves=4, every=3))
    with ThreadPoolExecutor(2) as pool:
        traces = list(pool.map(lambda run: simulate(case, 9, run), [0, 1, 0]))
    assert np.array_equal(traces[0].best_path_length, traces[2].best_path_length)
    assert np.array_equal(traces[0].ratios, traces[2].ratios)
    assert not np.array_equal(traces[0].best_path_length, traces[1].best_path_length)


def test_conditions_of_a_run_are_a_pair_until_the_first_copy() -> None:
    alone = simulate(condition(NoTeacher(), evaluate_every=1, points=60), 4, 0)
    pair = simulate(condition(CopyEachOther(moves=4, every=1_000_000), evaluate_every=1, points=60), 4, 0)
    assert np.array_equal(alone.best_path_length[0], pair.best_path_length[0])


def test_run_ends_with_its_goal_reachings() -> None:
    case = condition(NoTeacher(), steps=None, goal_reachings=25, points=40)
    simulation = Simulation(case, 1, 0)
    trace = simulation.trace(simulation.advance())
    assert simulation.one.agent.arrivals[0] == 25
    assert trace.best_path_length.shape == (1, min(40, trace.steps // 10))


def test_learning_reaches_the_shortest_path() -> None:
    trace = simulate(condition(NoTeacher(), steps=200_000), 1, 0)
    assert trace.best_path_length[0, -1] == 9
    assert trace.best_path_length[0, 0] == OPEN_10.longest_path
