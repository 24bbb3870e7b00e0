"""The learning robot: eq. 7 on durations, its reports, and going on from a snapshot bit for bit."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from robot_agent.policies.learner import LearningPolicy
from robot_agent.reports import Reporter
from swarm.geometry import Grid, Move
from swarm.learning.controller import Controller
from swarm.learning.learner import Learner, Transition
from swarm.learning.memory import Approach, ImitationMemory, ObservedPath
from swarm.learning.q_table import QTable
from swarm.messages import topics
from swarm.messages.topics import Topic
from tests.support.local_node import LocalNode

GRID = Grid(4, 4)
PATHS = (ObservedPath((Move.SE,) * 3), ObservedPath((Move.E, Move.S)), ObservedPath((Move.N, Move.N)))


class Rig:
    """A learner, its table, and what it said."""

    def __init__(
        self,
        seed: int = 1,
        *,
        paths: tuple[ObservedPath, ...] = (),
        moves: int = 1000,
        evaluation_seed: int = 2,
    ) -> None:
        self.node = LocalNode()
        self.q = QTable(GRID.states)
        memory = ImitationMemory(0.8, Approach.AVERAGE_Q, capacity=3)
        rng, evaluation_rng = np.random.default_rng(seed), np.random.default_rng(evaluation_seed)
        self.controller = Controller(self.q, memory, 0.1, rng)
        learner = Learner(
            GRID, self.controller, evaluation_rng, path_length_cap=50, discount_rate_per_s=0.149
        )
        self.learner = LearningPolicy(learner, moves, Reporter(self.node, "r1"))
        for path in paths:
            self.learner.remember(path, "given")

    def of(self, topic: Topic[Any]) -> list[Any]:
        return [message for key, message in self.node.published if key == topic.key("r1")]

    def walk(self, state: int, moves: int) -> int:
        """Moves of 2 or 3 s through the grid; the last state."""
        for _ in range(moves):
            action = self.learner.choose(state)
            entered = GRID.neighbour(state, action)
            blocked, next_state = entered is None, state if entered is None else entered
            duration_s = 0.5 if blocked else 2.0 + action % 2
            self.learner.learn(Transition(state, action, next_state, duration_s, blocked))
            state = GRID.start if next_state == GRID.goal else next_state
        return state


def test_the_reward_is_discounted_over_the_move_that_earns_it() -> None:
    rig = Rig()
    rig.learner.learn(Transition(10, Move.SE, GRID.goal, 3.0, False))
    expected = 0.2 * math.exp(-0.149 * 3.0)
    assert rig.q.values[10][Move.SE] == pytest.approx(expected)
    move = rig.of(topics.MOVE)[0]
    assert (move.number, move.track, move.state, move.action, move.next_state) == (1, 1, 10, Move.SE, 15)
    assert (move.reward, move.duration_s, move.blocked, move.path) == (1.0, 3.0, False, 0)
    assert move.q_value == move.q_change == pytest.approx(expected)
    assert rig.learner.tracks == 1


def test_the_value_of_the_next_cell_is_discounted_over_the_duration() -> None:
    rig = Rig()
    rig.q.values[6][Move.S] = 0.5
    rig.learner.learn(Transition(5, Move.E, 6, 2.0, False))
    assert rig.q.values[5][Move.E] == pytest.approx(0.2 * math.exp(-0.298) * 0.5)


def test_moves_tracks_and_best_paths_are_counted() -> None:
    rig = Rig(paths=PATHS)
    rig.walk(GRID.start, 100)
    moves = rig.of(topics.MOVE)
    assert [move.number for move in moves] == list(range(1, 101))
    assert [best.move for best in rig.of(topics.BEST_PATH)] == list(range(10, 101, 10))
    arrivals = sum(move.next_state == GRID.goal for move in moves)
    assert rig.learner.tracks == arrivals > 0
    assert moves[-1].track == 1 + sum(move.next_state == GRID.goal for move in moves[:-1])


def test_replays_are_reported_with_path_and_outcome() -> None:
    rig = Rig(paths=PATHS)
    rig.walk(GRID.start, 300)
    replays = rig.of(topics.REPLAY)
    assert {replay.path for replay in replays} == {1, 2, 3}
    assert {replay.outcome for replay in replays} == {"completed", "rejected", "blocked", "goal"}
    replayed = [move for move in rig.of(topics.MOVE) if move.path]
    under_way = rig.controller.replay.index + 1 if rig.controller.replay else 0
    assert len(replayed) == sum(replay.moves for replay in replays) + under_way
    for number, path in enumerate(PATHS, 1):
        kinds = {move.action for move in replayed if move.path == number}
        assert kinds <= {int(move) for move in path.moves}


def test_looking_at_the_learning_does_not_change_it() -> None:
    """The greedy path's ties have a generator of their own."""
    one, other = Rig(3), Rig(3, evaluation_seed=99)
    one.walk(GRID.start, 200)
    other.walk(GRID.start, 200)
    assert one.q.values == other.q.values


def test_a_learner_goes_on_from_its_snapshot_bit_for_bit() -> None:
    """Interrupted three times, in the middle of a replay or not, and restored through JSON."""
    whole, first = Rig(5, paths=PATHS), Rig(5, paths=PATHS)
    whole.walk(GRID.start, 400)
    state = GRID.start
    for interrupted_after in (1, 57, 99):
        state = first.walk(state, interrupted_after)
        snapshot = json.loads(json.dumps(first.learner.snapshot()))
        second = Rig(1234)
        second.learner.restore(snapshot)
        second.node.published[:0] = first.node.published
        first = second
    first.walk(state, 400 - 157)
    assert first.q.values == whole.q.values
    assert first.node.published == whole.node.published
    assert (first.learner.moves, first.learner.tracks) == (400, whole.learner.tracks)


def test_a_snapshot_of_another_grid_is_refused() -> None:
    snapshot = Rig().learner.snapshot()
    snapshot["controller"]["q"].pop()
    with pytest.raises(ValueError, match="15 states; the grid has 16"):
        Rig().learner.restore(snapshot)


def test_it_finishes_after_its_moves() -> None:
    rig = Rig(moves=5)
    rig.walk(GRID.start, 4)
    assert not rig.learner.finished
    rig.walk(GRID.start, 1)
    assert rig.learner.finished
