"""Puts one robot together from the experiment's settings: the only place that knows every part."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from google.protobuf.message import Message

from robot_agent.agent import Agent
from robot_agent.drivers.interfaces import Driver, DriverParts
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.registry import make_driver
from robot_agent.inbox import AgentInbox
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseAt, PoseEstimator
from robot_agent.policies.expert import Expert
from robot_agent.policies.learner import Learner
from robot_agent.policies.policy import Policy, Publish
from robot_agent.reports import Reporter
from swarm.config.experiment import Experiment, RobotSettings, Role
from swarm.learning.controller import Controller
from swarm.learning.memory import ImitationMemory
from swarm.learning.q_table import QTable
from swarm.learning.random import spawned_generator
from swarm.messages.topics import Topic
from swarm.runtime.node import Node

if TYPE_CHECKING:
    from robot_agent.imitation.visit import BeginVisit


class Assembly:
    """Makes the agents of one process for one trial."""

    def __init__(self, experiment: Experiment, node: Node, trial: int) -> None:
        self._experiment = experiment
        self._node = node
        self._seed = experiment.run.seed
        self._trial = trial

    def agent(self, name: str) -> Agent:
        """The agent of the robot with this id."""
        settings, robot = self._experiment, self._experiment.robot_named(name)

        def publish(topic: Topic[Any], message: Message) -> None:
            self._node.publish(topic, message, name)

        generator = partial(self._generator, robot)
        parts = DriverParts(settings, robot, EpuckGeometry(), self._node, generator)
        driver = make_driver(parts)
        policy = self._policy(robot, publish)
        estimator = PoseEstimator(parts.geometry)
        motion = MotionSettings(period_s=settings.simulation.tick_s)
        return Agent(
            settings.compartment(robot),
            policy,
            driver.body,
            estimator,
            Motion(motion, parts.geometry),
            AgentInbox(self._node, name),
            Reporter(publish),
            settings.learning.blocked_move_s,
            settings.learning.rest_s,
            _visits(parts, driver, policy, estimator.pose, publish),
        )

    def _policy(self, robot: RobotSettings, publish: Publish) -> Policy:
        grid = self._experiment.compartment(robot).grid
        if robot.role is Role.EXPERT:
            return Expert(grid, publish)
        rules = self._experiment.learning
        memory = ImitationMemory(rules.beta, rules.approach, rules.capacity)
        controller = Controller(
            QTable(grid.states), memory, rules.epsilon, self._generator(robot, "controller")
        )
        learner = Learner(
            grid,
            controller,
            self._generator(robot, "evaluation"),
            publish,
            moves_to_make=self._experiment.run.moves,
            path_length_cap=rules.path_length_cap,
            discount_rate_per_s=rules.discount_rate_per_s,
        )
        for path in robot.given_paths():
            learner.remember(path, "given")
        return learner

    def _generator(self, robot: RobotSettings, component: str) -> np.random.Generator:
        return spawned_generator(self._seed, robot.group, self._trial, robot.id, component)


def _visits(
    parts: DriverParts, driver: Driver, policy: Policy, pose_at: PoseAt, publish: Publish
) -> BeginVisit | None:
    """Only a robot that watches loads what it takes to see."""
    if not parts.robot.watches or not isinstance(policy, Learner):
        return None
    from robot_agent.imitation.assembly import visits_of

    return visits_of(parts, driver, policy, pose_at, publish)
