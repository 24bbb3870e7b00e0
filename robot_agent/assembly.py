"""Puts one robot together from the experiment's settings: the only place that knows every part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from robot_agent.activities import Task
from robot_agent.agent import Agent
from robot_agent.drivers.interfaces import Driver, DriverParts
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.reflex import with_reflex
from robot_agent.drivers.registry import make_driver
from robot_agent.inbox import AgentInbox
from robot_agent.navigation.motion import Motion, MotionSettings
from robot_agent.navigation.pose_estimator import PoseAt, PoseEstimator
from robot_agent.policies.access import AccessedRobot
from robot_agent.policies.expert import ExpertPolicy
from robot_agent.policies.learner import LearningPolicy
from robot_agent.policies.policy import Policy
from robot_agent.reports import Reporter
from swarm.config.experiment import Experiment, RobotSettings, Role
from swarm.messages import topics
from swarm.runtime.emergency_latch import EmergencyLatch
from swarm.runtime.node import Node

if TYPE_CHECKING:
    from robot_agent.imitation.visit import BeginVisit


@dataclass(frozen=True)
class Place:
    """Where and in what time the robots are: what a command line says beside the experiment."""

    addresses: Mapping[str, str] = field(default_factory=dict)
    """Of robots that are somewhere else than the experiment says: emulated ones."""
    speed: float = 1.0
    lockstep: bool = False
    state: Path | None = None
    """Where an emergency stop is kept over a restart."""

    def latch(self, robot: str) -> EmergencyLatch:
        """What a robot keeps of an emergency stop."""
        return EmergencyLatch(self.state / f"{robot}.estop" if self.state else None)


class Assembly:
    """Makes the agents of one process for one trial."""

    def __init__(self, experiment: Experiment, node: Node, trial: int, place: Place | None = None) -> None:
        self._experiment = experiment
        self._node = node
        self._trial = trial
        self._place = place or Place()

    def agent(self, name: str) -> Agent:
        """The agent of the robot with this id."""
        settings, robot = self._experiment, self._experiment.robot_named(name)
        reporter = Reporter(self._node, name)
        parts = self.driver_parts(name)
        driver, estimator = make_driver(parts), PoseEstimator(parts.geometry)
        policy = self._policy(robot, reporter)
        task = Task(
            settings.compartment(robot),
            policy,
            Motion(MotionSettings(period_s=settings.simulation.tick_s), parts.geometry),
            AgentInbox(self._node, name, settings.run, self._place.latch(name)),
            settings.learning.blocked_move_s,
            settings.learning.rest_s,
            _visits(parts, driver, policy, estimator.pose, reporter),
        )
        return Agent(task, with_reflex(driver.body, robot.keep_off_m), estimator, reporter)

    def driver_parts(self, name: str) -> DriverParts:
        """What the driver of the robot with this id is made from."""
        robot, place = self._experiment.robot_named(name), self._place
        return DriverParts(
            self._experiment,
            robot,
            EpuckGeometry.calibrated(robot.wheel_diameter_m, robot.wheel_base_m),
            self._node,
            partial(self._experiment.generator, robot, self._trial),
            place.addresses.get(name, robot.address),
            place.speed,
            place.lockstep,
        )

    def _policy(self, robot: RobotSettings, reporter: Reporter) -> Policy:
        experiment = self._experiment
        if robot.role is Role.EXPERT:
            return ExpertPolicy(experiment.compartment(robot).grid, reporter)
        policy = LearningPolicy(
            experiment.learner(robot, self._trial),
            experiment.run.moves,
            reporter,
            is_accessed=experiment.is_accessed(robot),
            accessed=self._accessed(robot),
        )
        for path in robot.given_paths():
            policy.remember(path, "given")
        return policy

    def _accessed(self, robot: RobotSettings) -> AccessedRobot | None:
        """The other robot whose internal state this one may read: nobody subscribes to it otherwise."""
        if not robot.accesses:
            return None
        told = self._node.subscribe(topics.BEST_MOVES, robot.accesses)
        return AccessedRobot(told, self._experiment.compartment(robot).grid.states)


def _visits(
    parts: DriverParts, driver: Driver, policy: Policy, pose_at: PoseAt, reporter: Reporter
) -> BeginVisit | None:
    """Only a robot that watches loads what it takes to see."""
    if not parts.robot.watches or not isinstance(policy, LearningPolicy):
        return None
    from robot_agent.imitation.assembly import visits_of

    return visits_of(parts, driver, policy, pose_at, reporter)
