"""Logs of learning without wheels: the robot's own learning policy and reporter, on drawn durations."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.message import Message
from mcap.reader import make_reader

from robot_agent.policies.learner import LearningPolicy
from robot_agent.reports import Reporter
from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.learning.learner import LearnerSnapshot, Transition
from swarm.learning.memory import ObservedPath
from swarm.messages import swarm_pb2 as pb
from swarm.messages.topics import topic_of
from tests.support.local_node import LocalNode
from tests.support.small_logs import TICK_NS, SmallLog, metadata
from tests.support.swarm_runs import experiment_text

ROBOT = "imitator"


class LearningRobot:
    """One learner with a given path, whose moves take no driving, and the log of what it says."""

    def __init__(self, path: Path, **learning: Any) -> None:
        text = experiment_text(moves=10_000)
        self.experiment = Experiment.of_log("test", text, learning).changed(seed=1)
        head = metadata(robots={ROBOT: "learner given"})
        self._log = SmallLog(path, {**head, "experiment": {"toml": text}})
        self._settings = self.experiment.robot_named(ROBOT)
        self._grid = self.experiment.compartment(self._settings).grid
        self._durations = np.random.default_rng(5)
        self._epoch = 0
        self._t_ns = NS_PER_S
        self.state = self._grid.start
        self.actions: list[int] = []
        self.start()

    def start(self, saved: LearnerSnapshot | None = None) -> None:
        """The robot's process starts, anew or from a checkpoint."""
        self._epoch += 1
        self._node = LocalNode()
        self._reporter = Reporter(self._node, ROBOT)
        learner = self.experiment.learner(self._settings, 0)
        self.policy = LearningPolicy(learner, 10_000, self._reporter)
        for path in self._settings.given_paths():
            self.policy.remember(path, "given")
        if saved:
            self.policy.restore(saved)
        self._say()

    def move(self, count: int = 1) -> None:
        """So many moves, from the goal back to the start."""
        for _ in range(count):
            action = self.policy.choose(self.state)
            entered = self._grid.neighbour(self.state, action)
            duration_s = 0.5 if entered is None else float(self._durations.normal(2.4, 0.2))
            arrived = self.state if entered is None else entered
            self.policy.learn(Transition(self.state, action, arrived, duration_s, entered is None))
            self.actions.append(action)
            self.state = self._grid.start if arrived == self._grid.goal else arrived
            self._say()

    def give_up_a_move(self) -> None:
        """It decides, and somebody carries it away before it arrives."""
        self.policy.choose(self.state)
        self.policy.abandon()
        self.carried_away()

    def carried_away(self) -> None:
        """As the agent's event has it."""
        self._reporter.warning("displaced", f"carried away from cell {self.state}; not learnt from")
        self._say()

    def visit(self, *moves: str) -> None:
        """It watches another robot, and remembers what it saw."""
        self.policy.abandon()
        self._reporter.visit(1, pb.Visit.READY)
        if moves:
            self.policy.remember(ObservedPath.parse(moves), "camera", 1)
        self.state = self._grid.start
        self._say()

    def close(self) -> Path:
        self._say()
        return self._log.close()

    def _say(self) -> None:
        """Everything new in one moment, as in one tick."""
        for key, message in self._node.published:
            self._log.t_ns = self._t_ns - TICK_NS
            self._log.add(key, message, self._epoch)
        self._node.published.clear()
        self._t_ns += NS_PER_S


def learnt_log(path: Path, moves: int, **learning: Any) -> LearningRobot:
    """A robot that has made so many moves, with a visit after every 40, and its closed log."""
    robot = LearningRobot(path, **learning)
    for place in range(moves // 40):
        robot.move(40)
        robot.visit(*(["SE", "E", "S", "SE", "S"], ["N", "W", "SE", "SE"], [])[place % 3])
    robot.close()
    return robot


def rewritten(log: Path, path: Path, change: Callable[[Message], Message | None]) -> Path:
    """The log once more, each message as `change` leaves it; None leaves it out."""
    with log.open("rb") as file:
        reader = make_reader(file)
        head = {record.name: record.metadata for record in reader.iter_metadata()}
        again = SmallLog(path, {name: head[name] for name in ("experiment", "run", "robots", "versions")})
        for _, channel, one in reader.iter_messages(log_time_order=False):
            found = topic_of(channel.topic)
            assert found
            message = change(found[0].message.FromString(one.data))
            if message is not None:
                again.t_ns = one.publish_time - TICK_NS
                again.add(channel.topic, message, int(channel.metadata["epoch"]))
    return again.close()
