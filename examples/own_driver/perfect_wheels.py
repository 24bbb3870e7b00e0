"""The driver `perfect`: simulated wheels that do at once what they are told, and never slip.

What differs between a run with it and one with the driver `sim` is due to the wheels. There are no walls
either: the agent drives no move into one.
"""

from __future__ import annotations

import math

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.interfaces import Camera, DriverParts
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds, WheelSteps
from robot_agent.vision.camera_model import CameraModel
from swarm.errors import UserError
from swarm.geometry import Pose, wrap_angle_rad
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics


class PerfectWheels:
    """Two wheels at constant speeds between commands, and where they have brought the robot.

    Without a fresh command for 0.3 s they stand: every driver's do, whatever became of its agent.
    """

    def __init__(self, geometry: EpuckGeometry, start: Pose) -> None:
        self._geometry = geometry
        self._pose = start
        self._speeds = STOPPED
        self._t_ns = self._stand_ns = 0
        self._left_steps = 0.0
        self._right_steps = 0.0

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        self._roll(t_ns)
        self._speeds = self._geometry.sendable(speeds)
        self._stand_ns = t_ns + round(STOP_WITHIN_S * 1e9)
        return self._speeds

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        self._roll(t_ns)
        return WheelSteps(math.floor(self._left_steps), math.floor(self._right_steps))

    def pose(self, t_ns: int) -> Pose:
        """Where the robot is."""
        self._roll(t_ns)
        return self._pose

    def close(self) -> None:
        self._speeds = STOPPED

    def _roll(self, t_ns: int) -> None:
        rolling_ns = max(0, min(t_ns, self._stand_ns) - self._t_ns)
        elapsed_s, self._t_ns = rolling_ns * 1e-9, t_ns
        left = self._speeds.left_steps_per_s * elapsed_s
        right = self._speeds.right_steps_per_s * elapsed_s
        self._left_steps += left
        self._right_steps += right
        self._pose = self._along_the_arc(left * self._geometry.step_m, right * self._geometry.step_m)

    def _along_the_arc(self, left_m: float, right_m: float) -> Pose:
        half_turn_rad = 0.5 * (right_m - left_m) / self._geometry.wheel_base_m
        chord_m = 0.5 * (left_m + right_m)
        if half_turn_rad:
            chord_m *= math.sin(half_turn_rad) / half_turn_rad
        heading_rad = self._pose.theta_rad + half_turn_rad
        return Pose(
            self._pose.x_m + chord_m * math.cos(heading_rad),
            self._pose.y_m + chord_m * math.sin(heading_rad),
            wrap_angle_rad(heading_rad + half_turn_rad),
        )


class ShownToTheTracker:
    """Wheels that tell the simulated tracker where the robot is, whenever they are read.

    The driver of a real robot needs no such thing: there the tracking system looks by itself.
    """

    def __init__(self, wheels: PerfectWheels, parts: DriverParts) -> None:
        self._wheels = wheels
        self._parts = parts

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        return self._wheels.drive(speeds, t_ns)

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        pose = self._wheels.pose(t_ns)
        truth = pb.Truth(x_m=pose.x_m, y_m=pose.y_m, theta_rad=pose.theta_rad)
        self._parts.node.publish(topics.TRUTH, truth, self._parts.robot.id)
        return self._wheels.wheel_steps(t_ns)

    def close(self) -> None:
        self._wheels.close()


class PerfectDriver:
    """A robot with perfect wheels at its compartment's start, and without a camera."""

    def __init__(self, parts: DriverParts) -> None:
        compartment = parts.experiment.compartment(parts.robot)
        start = Pose(*compartment.centre(compartment.grid.start), 0.0)
        self._robot = parts.robot.id
        self.body = ShownToTheTracker(PerfectWheels(parts.geometry, start), parts)

    def camera(self, model: CameraModel) -> Camera:  # noqa: ARG002
        raise UserError(f"robot {self._robot!r}: the driver 'perfect' has no camera; remove 'watches'")
