"""Algorithms 1-3 step by step, with the random numbers laid out by hand."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest

from swarm.geometry import MOVES, Move
from swarm.learning.controller import Controller, Outcome
from swarm.learning.memory import Approach, ImitationMemory, ObservedPath
from swarm.learning.q_table import GAMMA, QTable

STATES = 8
IMITATE, NOT_IMITATE = 0.49, 0.5
"""Just below and at p_imitate = beta = 0.5 of a new path."""
GREEDY, EXPLORE = 0.1, 0.099
"""At and just below epsilon = 0.1."""


class Numbers:
    """Random numbers as laid out; asking for more than there are fails the test."""

    def __init__(self, uniform: Sequence[float] = (), whole: Sequence[int] = ()) -> None:
        self.uniform = list(uniform)
        self.whole = list(whole)

    def random(self) -> float:
        return self.uniform.pop(0)

    def integers(self, high: int) -> int:
        value = self.whole.pop(0)
        assert value < high
        return value

    @property
    def left(self) -> int:
        return len(self.uniform) + len(self.whole)


def controller_with(path: str, numbers: Numbers) -> Controller:
    memory = ImitationMemory(0.5, Approach.AVERAGE_Q)
    if path:
        memory.remember(ObservedPath.parse(path.split()))
    return Controller(QTable(STATES), memory, 0.1, numbers)


def follow(controller: Controller, state: int, reward: float = 0.0) -> int:
    """Choose and learn one move to the next state; the action."""
    action = controller.choose(state)
    controller.learn(state, action, reward, state + 1, GAMMA)
    return action


def test_a_path_is_replayed_move_by_move_and_counted_when_complete() -> None:
    numbers = Numbers([IMITATE])
    controller = controller_with("SE E S", numbers)
    assert [follow(controller, state) for state in range(3)] == [Move.SE, Move.E, Move.S]
    assert numbers.left == 0, "a replay draws one number at its start and none on the way"
    ended = controller.ended
    assert ended is not None
    assert (ended.moves, ended.outcome, ended.q_change) == (3, Outcome.COMPLETED, 0.0)
    entry = controller.memory.remembered[0]
    assert (entry.n_replicated, entry.n_completed, entry.n_q_plus) == (1, 1, 0)
    assert controller.memory.ratio(entry) == 0.5


def test_p_imitate_is_compared_strictly() -> None:
    controller = controller_with("SE E", Numbers([NOT_IMITATE, GREEDY], [3]))
    assert controller.choose(0) == Move.SW
    assert controller.replay is None


def test_epsilon_is_compared_strictly_and_a_random_action_may_be_any() -> None:
    controller = controller_with("", Numbers([EXPLORE, GREEDY], [int(Move.NE), 0]))
    controller.q.values[0][Move.E] = 1.0
    assert controller.choose(0) == Move.NE
    assert controller.choose(0) == Move.E


def test_a_better_action_rejects_the_path_and_the_agent_acts_epsilon_greedily() -> None:
    controller = controller_with("SE E S", Numbers([IMITATE, GREEDY], [0]))
    controller.q.values[1][Move.N] = 0.5
    assert follow(controller, 0) == Move.SE
    assert controller.choose(1) == Move.N
    assert controller.ended is not None
    assert (controller.ended.moves, controller.ended.outcome) == (1, Outcome.REJECTED)
    assert controller.replay is None


def test_a_rejected_path_may_still_explore() -> None:
    controller = controller_with("SE E S", Numbers([IMITATE, EXPLORE], [int(Move.W)]))
    controller.q.values[0][Move.N] = 0.5
    assert controller.choose(0) == Move.W
    assert controller.ended is not None
    assert (controller.ended.moves, controller.ended.outcome) == (0, Outcome.REJECTED)
    assert controller.memory.remembered[0].n_replicated == 1


def test_the_last_action_of_a_path_is_not_checked() -> None:
    controller = controller_with("SE E", Numbers([IMITATE]))
    controller.q.values[1][Move.N] = 0.5
    assert follow(controller, 0) == Move.SE
    assert follow(controller, 1) == Move.E
    assert controller.ended is not None
    assert controller.ended.outcome is Outcome.COMPLETED


def test_the_first_action_is_checked_even_of_a_path_of_one() -> None:
    """The listing checks for completion only when it advances in a path that is under way."""
    controller = controller_with("E", Numbers([IMITATE, GREEDY], [0]))
    controller.q.values[0][Move.N] = 0.5
    assert controller.choose(0) == Move.N


def test_a_replay_that_raised_q_counts_into_r() -> None:
    controller = controller_with("SE E", Numbers([IMITATE]))
    follow(controller, 0)
    follow(controller, 1, reward=1.0)
    ended = controller.ended
    assert ended is not None
    assert ended.q_change == pytest.approx(0.2)
    entry = controller.memory.remembered[0]
    assert (entry.n_replicated, entry.n_q_plus) == (1, 1)
    assert controller.memory.ratio(entry) == 1.0


def test_a_replay_that_lowered_q_more_than_it_raised_does_not_count() -> None:
    """The first move loses 0.2 * 1 of Q(0, SE) = 1, the second wins 0.1."""
    controller = controller_with("SE E", Numbers([IMITATE]))
    controller.q.values[0][Move.SE] = 1.0
    follow(controller, 0)
    follow(controller, 1, reward=0.5)
    assert controller.ended is not None
    assert controller.ended.q_change == pytest.approx(-0.1)
    assert controller.memory.remembered[0].n_q_plus == 0


@pytest.mark.parametrize(
    ("ending", "outcome"), [({"blocked": True}, Outcome.BLOCKED), ({"arrived": True}, Outcome.GOAL)]
)
def test_a_wall_and_the_goal_end_a_replay(ending: dict[str, bool], outcome: Outcome) -> None:
    controller = controller_with("SE E S", Numbers([IMITATE]))
    action = controller.choose(0)
    controller.learn(0, action, 0.0, 0, GAMMA, **ending)
    assert controller.ended is not None
    assert (controller.ended.moves, controller.ended.outcome) == (1, outcome)
    entry = controller.memory.remembered[0]
    assert (entry.n_replicated, entry.n_completed) == (1, 0)


def test_paths_are_started_as_often_as_p_imitate_says() -> None:
    """Eight paths of equal R: one starts in half the decisions, each as often as any other."""
    rng, decisions = np.random.default_rng(2), 8000
    memory = ImitationMemory(0.5, Approach.FIXED)
    for move in Move:
        memory.remember(ObservedPath((move, move)))
    controller = Controller(QTable(STATES), memory, 0.1, rng)
    started: Counter[int] = Counter()
    for _ in range(decisions):
        action = controller.choose(0)
        if controller.replay:
            started[action] += 1
        controller.replay = None
    assert abs(sum(started.values()) - decisions / 2) < 4 * (decisions / 4) ** 0.5
    expected = decisions / 2 / MOVES
    assert all(abs(started[move] - expected) < 4 * expected**0.5 for move in range(MOVES))


def test_without_paths_no_number_is_drawn_for_imitation() -> None:
    numbers = Numbers([GREEDY], [5])
    assert controller_with("", numbers).choose(0) == Move.NW
    assert numbers.left == 0
