"""Robots without wheels learn by the very same rules as robots, and copy what stored copies say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf.message import Message

from robot_agent.policies.learner import Learner
from robot_agent.policies.policy import Transition
from swarm.config.experiment import Experiment
from swarm.geometry import Grid, Move
from swarm.learning.controller import Controller
from swarm.learning.memory import ImitationMemory
from swarm.learning.q_table import QTable
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.surrogate.copies import CopyPair, CopyStore
from swarm.surrogate.durations import KINDS, Durations
from swarm.surrogate.robots import ShownMoves, SurrogateLearner
from swarm.surrogate.trial import RobotTrial, longest_drive, window
from tests.support.swarm_runs import ROOT

DURATIONS = Durations({kind: [2.0, 2.5] if "turn" in kind else [20.0] for kind in KINDS})
EXPERT = (Move.SE,) * 5
TRUE_COPIES = CopyStore((CopyPair("random", EXPERT, EXPERT),) * 2)


def deployed(name: str, moves: int) -> Experiment:
    return Experiment.load(ROOT / "deploy" / "sim" / f"{name}.toml").changed(moves=moves)


class Recorded(SurrogateLearner):
    """Keeps what it went through, so that another learner can go through the same."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.transitions: list[Transition] = []

    def learn(
        self, state: int, action: int, next_state: int, duration_s: float, *, blocked: bool, arrived: bool
    ) -> None:
        super().learn(state, action, next_state, duration_s, blocked=blocked, arrived=arrived)
        self.transitions.append(Transition(state, action, next_state, duration_s, blocked))


def test_it_decides_and_learns_as_a_robot_does() -> None:
    """The robot's own learner, given the same random numbers and durations, makes the very same choices."""
    experiment = deployed("expert", 400)
    settings = replace(experiment.robot_named("loner"), paths=(("SE",) * 5, ("E", "S", "E")))
    fast = Recorded(experiment, settings, DURATIONS, 3)
    for _ in range(400):
        fast.move()
    robot, best_paths, controller = robot_learner(experiment, fast)
    for transition in fast.transitions:
        assert robot.choose(transition.state) == transition.action
        robot.learn(transition)
    assert controller.q.values == fast.controller.q.values
    assert best_paths == fast.best_paths
    assert any(max(row) > 0 for row in controller.q.values), "it did reach the goal"
    counts = [(each.n_replicated, each.n_q_plus) for each in controller.memory.remembered]
    assert counts == [(each.n_replicated, each.n_q_plus) for each in fast.memory.remembered]


def robot_learner(experiment: Experiment, fast: SurrogateLearner) -> tuple[Learner, list[int], Controller]:
    rules, best_paths = experiment.learning, list[int]()

    def publish(topic: Topic[Any], message: Message) -> None:
        if topic is topics.BEST_PATH:
            best_paths.append(message.length)  # type: ignore[attr-defined]

    grid = Grid(10, 10)
    memory = ImitationMemory(rules.beta, rules.approach, rules.capacity)
    controller = Controller(QTable(grid.states), memory, rules.epsilon, fast.generator("controller"))
    learner = Learner(
        grid,
        controller,
        fast.generator("evaluation"),
        publish,
        moves_to_make=experiment.run.moves,
        path_length_cap=rules.path_length_cap,
        discount_rate_per_s=rules.discount_rate_per_s,
    )
    for path in fast.settings.given_paths():
        learner.remember(path, "given")
    return learner, best_paths, controller


def test_a_learner_copies_its_expert_until_its_memory_is_full() -> None:
    outcome = RobotTrial(deployed("expert", 1500), DURATIONS, TRUE_COPIES, 0).run()
    assert [copied.robot for copied in outcome.copies] == ["imitator"] * 10
    assert outcome.copies[0].move == 0, "it watches before its first move"
    assert all(set(copied.true) == {Move.SE} for copied in outcome.copies)
    assert {name: len(lengths) for name, lengths in outcome.best_paths.items()} == {
        "imitator": 150,
        "loner": 150,
    }


def test_two_learners_copy_what_the_other_did() -> None:
    outcome = RobotTrial(deployed("each-other", 800), DURATIONS, TRUE_COPIES, 1).run()
    assert {copied.robot for copied in outcome.copies} == {"robot_a", "robot_b"}
    assert all(1 <= len(copied.true) <= 5 for copied in outcome.copies)
    assert len({copied.true for copied in outcome.copies}) > 3


def test_a_trial_can_be_repeated_and_another_differs() -> None:
    def curves(trial: int) -> dict[str, list[int]]:
        return RobotTrial(deployed("each-other", 500), DURATIONS, TRUE_COPIES, trial).run().best_paths

    assert curves(1) == curves(1)
    assert curves(1) != curves(2)


def test_refused_copies_are_not_remembered() -> None:
    refused = CopyStore((CopyPair("random", EXPERT, ()),))
    assert RobotTrial(deployed("expert", 200), DURATIONS, refused, 0).run().copies == ()


def test_only_moves_wholly_in_view_are_seen_and_of_one_journey() -> None:
    def shown(move: Move, began_s: float, track: int) -> ShownMoves:
        return ShownMoves(move, began_s, began_s + 2.0, track)

    seen = [shown(Move.N, 9.0, 0), shown(Move.E, 11.0, 0), shown(Move.S, 13.0, 0)]
    seen += [shown(Move.W, 36.0, 1), shown(Move.NW, 39.5, 1)]
    assert longest_drive(seen, 10.0, 41.0) == (Move.E, Move.S)
    assert longest_drive(seen, 50.0, 60.0) == ()


@pytest.mark.parametrize("count", [3, 5])
def test_a_window_is_consecutive_and_anywhere(count: int) -> None:
    moves = tuple(Move(number) for number in range(5))
    rng = np.random.default_rng(1)
    found = {window(moves, count, rng) for _ in range(100)}
    assert found == {moves[first : first + count] for first in range(6 - count)}


def test_the_deployed_stores_can_be_read() -> None:
    from swarm.surrogate.copies import load_copies
    from swarm.surrogate.durations import load_durations

    folder: Path = ROOT / "swarm" / "surrogate" / "data"
    assert len(load_copies(folder / "best.csv").pairs) >= 600
    rng = np.random.default_rng(1)
    durations = load_durations(folder / "durations.csv")
    assert 1.2 < durations.drawn("turn0-side", rng) < 6
    assert durations.drawn("drive_back", rng) > 15
