"""An e-puck as its firmware knows it: wheels at quantised speeds, 16-bit counters, sensors, lights."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from robot_agent.drivers.kinematics import STOPPED, WheelSpeeds
from robot_agent.drivers.motors import StepperMotors
from robot_agent.drivers.sim.body import SimulatedBody
from robot_agent.emulator.faults import Faults
from swarm.clock import NS_PER_S
from swarm.geometry import Compartment, Pose

PROXIMITY_ANGLES_RAD = tuple(math.radians(angle) for angle in (-17, -46, -90, -151, 151, 90, 46, 17))
"""Sensors ps0 to ps7 from the front, counter-clockwise (lpuck's table of infra-red poses)."""
PROXIMITY_M = (0.0, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06)
PROXIMITY_RAW = (4095.0, 2133.0, 1466.0, 601.0, 384.0, 235.0, 158.0, 120.0, 67.0)
"""Response of a sensor to a wall at these distances (epuck_ros2, INFRARED_TABLE); 67 is far away."""
AMBIENT_RAW = 3200
"""Ambient light of an ordinary room: any plausible number serves."""
FULL_BATTERY_V = 4.1
REMOTE_SPEED = 400
"""How fast a TV remote drives the robot (steps/s): any speed that shows."""
REMOTE_PERIOD_NS = NS_PER_S // 10
SPEEDS_REMEMBERED = 10_000
"""Changes of speed kept for whoever measures when the wheels stopped: hours of driving."""


class EmulatedRobot:
    """One robot. All times are the emulator's own and never go back.

    The firmware has no time-out: the wheels run as they were last told, for ever.
    """

    def __init__(
        self,
        body: SimulatedBody,
        motors: StepperMotors,
        walls: Compartment,
        faults: Faults,
        selector: int = 10,
    ) -> None:
        self.faults = faults
        self.selector = selector
        self.lights = 0
        """Bits 0 to 7 the ring, 8 the body, 9 the front."""
        self.commanded = (0, 0)
        self.speeds: deque[tuple[int, WheelSpeeds]] = deque(maxlen=SPEEDS_REMEMBERED)
        """When the wheels changed their speeds, and to what."""
        self._body = body
        self._motors = motors
        self._walls = walls
        self._offsets = [0, 0]
        self._began_ns: int | None = None
        self._remote_due_ns = 0

    def drive(self, left: int, right: int, t_ns: int) -> None:
        """Commanded speeds in steps/s, as a firmware takes them."""
        t_ns = self._advance(t_ns)
        self._run(left, right, t_ns)

    def counts(self, t_ns: int) -> tuple[int, int]:
        """Both step counters as the e-puck2 keeps them: they do not wrap."""
        steps = self._body.wheel_steps(self._advance(t_ns))
        return steps.left + self._offsets[0], steps.right + self._offsets[1]

    def counters(self, t_ns: int) -> tuple[int, int]:
        """Both step counters as all binary protocols send them, 0..65535."""
        left, right = self.counts(t_ns)
        return left & 0xFFFF, right & 0xFFFF

    def set_counters(self, left: int, right: int, t_ns: int) -> None:
        """Make the counters show these numbers now."""
        steps = self._body.wheel_steps(self._advance(t_ns))
        self._offsets = [left - steps.left, right - steps.right]

    def reset(self, t_ns: int) -> None:
        """Wheels and lights off, counters at zero: the processor starts anew."""
        self.drive(0, 0, t_ns)
        self.set_counters(0, 0, t_ns)
        self.lights = 0

    def truth(self, t_ns: int) -> Pose:
        return self._body.truth(self._advance(t_ns))

    def place(self, pose: Pose) -> None:
        """Put the robot somewhere by hand."""
        self._body.place(pose)

    @property
    def wall_contacts(self) -> int:
        return self._body.contacts

    def battery_v(self, t_ns: int) -> float:
        t_ns = self._advance(t_ns)
        return max(0.0, FULL_BATTERY_V - self.faults.sag_v_per_s * self._age_s(t_ns))

    def proximity(self, t_ns: int) -> tuple[int, ...]:
        """The eight infra-red sensors, 0..4095, from the distance of the walls along each."""
        pose = self.truth(t_ns)
        return tuple(self._echo(pose, angle) for angle in PROXIMITY_ANGLES_RAD)

    def ambient(self) -> tuple[int, ...]:
        return (AMBIENT_RAW,) * len(PROXIMITY_ANGLES_RAD)

    def _echo(self, pose: Pose, angle_rad: float) -> int:
        heading_rad = pose.theta_rad + angle_rad
        reach_m = _free_m(self._walls, pose, math.cos(heading_rad), math.sin(heading_rad))
        distance_m = reach_m - self._body.radius_m
        return round(float(np.interp(distance_m, PROXIMITY_M, PROXIMITY_RAW)))

    def _advance(self, t_ns: int) -> int:
        """Let the TV remote do what it does up to now."""
        if self._began_ns is None:
            self._began_ns = t_ns
            self._body.wheel_steps(t_ns)
            self._remote_due_ns = t_ns + round(self.faults.remote_after_s * NS_PER_S)
        while self.faults.remote_after_s and self._remote_due_ns <= t_ns:
            self._run(REMOTE_SPEED, REMOTE_SPEED, self._remote_due_ns)
            self._remote_due_ns += REMOTE_PERIOD_NS
        return t_ns

    def _run(self, left: int, right: int, t_ns: int) -> None:
        if (left, right) != self.commanded or not self.speeds:
            self.commanded = (left, right)
            running = self._motors.running(self.commanded)
            self._body.run_wheels(running, t_ns)
            self.speeds.append((t_ns, running))

    def _age_s(self, t_ns: int) -> float:
        return (t_ns - (self._began_ns or t_ns)) / NS_PER_S

    def standing_since_ns(self) -> int | None:
        """When the wheels stopped; None while they turn or before they were ever told anything."""
        if not self.speeds or self.speeds[-1][1] != STOPPED:
            return None
        return self.speeds[-1][0]


def _free_m(walls: Compartment, pose: Pose, ahead_x: float, ahead_y: float) -> float:
    """How far it is from the centre to the nearest wall in a direction; endless outside the walls."""
    if not (walls.west_m < pose.x_m < walls.east_m and walls.south_m < pose.y_m < walls.north_m):
        return math.inf
    to_x_m = (walls.east_m if ahead_x > 0 else walls.west_m) - pose.x_m
    to_y_m = (walls.north_m if ahead_y > 0 else walls.south_m) - pose.y_m
    across_m = to_x_m / ahead_x if ahead_x else math.inf
    along_m = to_y_m / ahead_y if ahead_y else math.inf
    return min(across_m, along_m)
