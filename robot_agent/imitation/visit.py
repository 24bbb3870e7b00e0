"""A visit: the robot is carried to where it can watch another, copies what it sees, and is carried back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robot_agent.drivers.interfaces import Camera
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds
from robot_agent.imitation.copying import Copy, NoCopy, copy_moves
from robot_agent.imitation.observer import Watch
from robot_agent.imitation.provenance import observation_message
from robot_agent.navigation.pose_estimator import PoseAt
from robot_agent.reports import Reporter
from robot_agent.vision.detector import Detector
from swarm.clock import NS_PER_S
from swarm.config.experiment import VisitSettings
from swarm.geometry import Move, Pose
from swarm.learning.memory import ObservedPath, choose_window
from swarm.messages import swarm_pb2 as pb

BeginVisit = Callable[[pb.Order], "Visit"]
"""Makes a visit of an order to watch; None in a robot without a camera."""


AT_PLACE_M = 0.05
"""Chosen: a hand does not set a robot down more exactly, and its pose is measured in any case."""
STANDS_FOR_NS = NS_PER_S
"""Ten fixes of a tracker at 10 Hz; chosen: enough for the heading to settle after being carried."""


@dataclass(frozen=True)
class Eyes:
    """What a robot needs to watch: a camera, a detector trained on the demonstrator's skirt, and a memory."""

    camera: Camera
    detector: Detector
    pose_at: PoseAt
    settings: VisitSettings
    cell_m: float
    start_m: tuple[float, float]
    """The middle of the demonstrator's start cell, where its drive back ends."""
    rng: np.random.Generator
    remember: Callable[[ObservedPath, int], int]


class Visit:
    """One visit, from the order to watch until the robot may be carried back."""

    def __init__(self, order: pb.Order, eyes: Eyes, geometry: EpuckGeometry, reporter: Reporter) -> None:
        self.number = order.visit
        self.done = False
        self._place = Pose(order.x_m, order.y_m, order.theta_rad)
        self._eyes = eyes
        self._geometry = geometry
        self._reporter = reporter
        self._watch: Watch | None = None
        self._standing_since_ns: int | None = None
        self._reporter.visit(self.number, pb.Visit.READY)

    def step(self, own_pose: Pose | None, t_ns: int) -> WheelSpeeds:
        """Wait for the place, then watch; the wheels only turn the robot in place."""
        if self.done:
            return STOPPED
        if self._watch is None:
            self._watch = self._begun_when_standing(own_pose, t_ns)
        if self._watch is None:
            return STOPPED
        turn_rad_per_s = self._watch.step(own_pose, t_ns)
        if self._watch.ended(t_ns):
            self._finish(self._watch)
            return STOPPED
        return self._geometry.wheel_speeds(0.0, turn_rad_per_s) if turn_rad_per_s else STOPPED

    def displaced(self) -> None:
        """The tracker says that the robot is elsewhere: on the way to the place, or pushed away from it."""
        self._standing_since_ns = None
        if self._watch:
            self._watch.failed = "the observer was pushed"

    def _begun_when_standing(self, own_pose: Pose | None, t_ns: int) -> Watch | None:
        """The tracker confirms that the robot stands at the place before the watching begins."""
        if own_pose is None or self._place.distance_m(own_pose) > AT_PLACE_M:
            self._standing_since_ns = None
        elif self._standing_since_ns is None:
            self._standing_since_ns = t_ns
        if self._standing_since_ns is None or t_ns - self._standing_since_ns < STANDS_FOR_NS:
            return None
        self._reporter.visit(self.number, pb.Visit.WATCHING)
        eyes = self._eyes
        duration_s, frames_per_s = eyes.settings.duration_s, eyes.settings.frames_per_s
        return Watch(eyes.camera, eyes.detector, eyes.pose_at, t_ns, duration_s, frames_per_s)

    def _finish(self, watch: Watch) -> None:
        copied = self._copied(watch)
        window = self._window(copied)
        profile = self._eyes.settings.profile.value
        self._reporter.observation(observation_message(self.number, profile, watch, copied, window))
        path = self._eyes.remember(ObservedPath(window), self.number) if window else 0
        reason = copied.reason if isinstance(copied, NoCopy) else ""
        self.done = True
        self._reporter.visit(self.number, pb.Visit.DONE, path, reason)

    def _window(self, copied: Copy | NoCopy) -> tuple[Move, ...]:
        """The moves that will be remembered; a copy has at least one."""
        if isinstance(copied, NoCopy):
            return ()
        return choose_window(copied.path().moves, self._eyes.settings.moves, self._eyes.rng)

    def _copied(self, watch: Watch) -> Copy | NoCopy:
        """Nothing is learnt from an observation that was given up."""
        if watch.failed:
            return NoCopy(watch.failed)
        eyes = self._eyes
        copied = copy_moves(
            watch.positions,
            eyes.settings.profile,
            eyes.cell_m,
            watch.expected_frames,
            eyes.start_m,
        )
        unseen = watch.commonest_reason()
        if isinstance(copied, NoCopy) and unseen:
            return NoCopy(f"{copied.reason} (mostly: {unseen})")
        return copied
