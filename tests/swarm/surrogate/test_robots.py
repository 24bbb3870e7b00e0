"""Robots without wheels learn by the very same rules as robots, and copy what stored copies say."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from robot_agent.policies.learner import LearningPolicy
from robot_agent.reports import Reporter
from swarm.config.experiment import Experiment, RobotSettings
from swarm.geometry import Move
from swarm.learning.learner import Transition
from swarm.messages import topics
from swarm.surrogate.copies import CopyPair, CopyStore
from swarm.surrogate.durations import KINDS, Durations
from swarm.surrogate.robots import ShownMoves, SurrogateLearner
from swarm.surrogate.trial import RobotTrial, longest_drive
from tests.support.local_node import LocalNode
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

    def learn(self, transition: Transition) -> None:
        super().learn(transition)
        self.transitions.append(transition)


def test_it_decides_and_learns_as_a_robot_does() -> None:
    """The robot's own learner, given the same random numbers and durations, makes the very same choices."""
    experiment = deployed("expert", 400)
    settings = replace(experiment.robot_named("loner"), paths=(("SE",) * 5, ("E", "S", "E")))
    fast = Recorded(experiment, settings, DURATIONS, 3)
    for _ in range(400):
        fast.move()
    robot, node = robot_policy(experiment, settings)
    for transition in fast.transitions:
        assert robot.choose(transition.state) == transition.action
        robot.learn(transition)
    best_paths = [message.length for key, message in node.published if key == topics.BEST_PATH.key("loner")]
    assert best_paths == fast.best_paths
    learnt = json.dumps(robot.snapshot())
    assert learnt == json.dumps(fast.learner.snapshot()), "table, memory, counts and random numbers to come"
    assert any(max(row) > 0 for row in robot.snapshot()["controller"]["q"]), "it did reach the goal"


def robot_policy(experiment: Experiment, settings: RobotSettings) -> tuple[LearningPolicy, LocalNode]:
    node = LocalNode()
    learner = experiment.learner(settings, 3)
    policy = LearningPolicy(learner, experiment.run.moves, Reporter(node, settings.id))
    for path in settings.given_paths():
        policy.remember(path, "given")
    return policy, node


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


def test_the_deployed_stores_can_be_read() -> None:
    from swarm.surrogate.copies import load_copies
    from swarm.surrogate.durations import load_durations

    folder: Path = ROOT / "swarm" / "surrogate" / "data"
    assert len(load_copies(folder / "best.csv").pairs) >= 600
    rng = np.random.default_rng(1)
    durations = load_durations(folder / "durations.csv")
    assert 1.2 < durations.drawn("turn0-side", rng) < 6
    assert durations.drawn("drive_back", rng) > 15
