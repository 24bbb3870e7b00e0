"""Where an emulator's robots are: a recording's, a run's, or circles that need neither."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, RobotSettings, TrackerSettings
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.validation import decode
from swarm.runtime.zenoh_session import Inbox, Session, SessionSettings, WireSample
from swarm.tracker_noise import measured
from tracker_bridge.backends.interface import TrackedPose

SPEED_M_PER_S = 0.1
"""An e-puck makes 0.13."""
GOOD_SYSTEM = TrackerSettings(noise_m=0.0002, noise_rad=0.002, loss=0.0)
"""Without any noise, robots that stand would repeat to the last bit and look frozen."""


class Circles:
    """Every robot drives round the middle of its compartment, a third of its side away."""

    def __init__(self, experiment: Experiment, rng: np.random.Generator) -> None:
        self._experiment = experiment
        self._rng = rng

    def poses(self, t_ns: int) -> list[TrackedPose]:
        return [self._robot(robot, t_ns) for robot in self._experiment.robot]

    def _robot(self, robot: RobotSettings, t_ns: int) -> TrackedPose:
        place = self._experiment.compartment(robot)
        radius_m = min(place.east_m - place.west_m, place.north_m - place.south_m) / 3
        angle_rad = SPEED_M_PER_S / radius_m * t_ns / NS_PER_S
        pose = Pose(
            (place.west_m + place.east_m) / 2 + radius_m * math.cos(angle_rad),
            (place.south_m + place.north_m) / 2 + radius_m * math.sin(angle_rad),
            angle_rad + math.pi / 2,
        )
        return TrackedPose(robot.id, _seen(pose, self._rng), t_ns)


class TruthOfRun:
    """The true places of a simulated run's robots, as the run publishes them."""

    def __init__(self, inbox: Inbox, rng: np.random.Generator) -> None:
        self._inbox = inbox
        self._rng = rng

    @classmethod
    @contextmanager
    def of(cls, settings: SessionSettings, rng: np.random.Generator) -> Iterator[TruthOfRun]:
        """Listens to the run's server for as long as the block lasts."""
        with Session(settings) as session:
            yield cls(session.inbox(topics.TRUTH.key(), topics.TRUTH.delivery, keep_all=True), rng)

    def poses(self, t_ns: int) -> list[TrackedPose]:
        return [self._tracked(sample, t_ns) for sample in self._inbox.poll()]

    def _tracked(self, sample: WireSample, t_ns: int) -> TrackedPose:
        found = topics.topic_of(sample.key)
        truth = decode(pb.Truth, sample.payload)
        true_pose = Pose(truth.x_m, truth.y_m, truth.theta_rad)
        return TrackedPose(found[1] if found else "", _seen(true_pose, self._rng), t_ns)


def _seen(pose: Pose, rng: np.random.Generator) -> Pose:
    """A pose as a good tracking system measures it; such a system loses nobody."""
    return measured(pose, GOOD_SYSTEM, rng.standard_normal(3).tolist(), loss=1.0) or pose
