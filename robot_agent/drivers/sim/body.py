"""A simulated e-puck: exact differential-drive kinematics with the faults of a real one."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, StepUnwrapper, WheelSpeeds, WheelSteps
from swarm.geometry import Compartment, Pose, wrap_angle_rad

SLIP_SLOT_NS = 100_000_000
"""Each wheel's slip is drawn anew in every slot of this length in which the wheels turn."""

_SLIPS_DRAWN_AT_ONCE = 256
_NEVER_NS = 1 << 63


@dataclass(frozen=True, slots=True)
class BodyFaults:
    """How far a robot's ground motion strays from its wheels' steps, and how late it obeys."""

    slip_sd: float = 0.01
    """Standard deviation of each wheel's relative slip in a slot of 0.1 s."""

    gain_error_sd: float = 0.015
    """Standard deviation of each wheel's relative error in size; drawn once a robot."""

    latency_s: float = 0.06
    """Time from a command to its effect."""


class SimulatedBody:
    """The body of a simulated robot inside the walls of a compartment.

    The state moves on only at instants that the commands and the slip's slots fix. Between them a query
    looks ahead along the exact arc and changes nothing, so that the course of a run does not depend, even
    in the last bit, on how often anyone looks. Time starts with the first call.

    A robot that is placed outside the walls (an observer, carried by hand) is not stopped by them.

    A command holds for `obeys_for_s`; then the wheels stop, unless a fresh one came. This is the watchdog of
    a real robot's driver, which outlives its agent: here the body and its agent are one process, so that an
    agent that is killed takes its body along, and one that hangs finds that its robot stood meanwhile.
    """

    def __init__(
        self,
        geometry: EpuckGeometry,
        faults: BodyFaults,
        pose: Pose,
        walls: Compartment,
        rng: np.random.Generator,
        obeys_for_s: float = math.inf,
    ) -> None:
        self.contacts = 0
        """How often the body has run into a wall, up to the last full slot."""
        self.radius_m = geometry.body_radius_m
        self._obeys_for_s = obeys_for_s
        self._expires_ns = _NEVER_NS
        self._geometry = geometry
        self._track_m = geometry.wheel_base_m
        self._rng = rng
        left_error, right_error = rng.normal(0.0, faults.gain_error_sd, 2).tolist()
        self._left_step_m = geometry.step_m * (1.0 + left_error)
        self._right_step_m = geometry.step_m * (1.0 + right_error)
        self._slip_sd = faults.slip_sd
        self._latency_ns = round(faults.latency_s * 1e9)
        radius_m = self.radius_m
        self._west_m, self._east_m = walls.west_m + radius_m, walls.east_m - radius_m
        self._south_m, self._north_m = walls.south_m + radius_m, walls.north_m - radius_m
        self._x_m, self._y_m, self._theta_rad = pose.x_m, pose.y_m, pose.theta_rad
        self._confined = self._inside(pose)
        self._touching = False
        self._started = self._rolling = False
        self._t_ns = self._latest_ns = 0
        self._next_ns = _NEVER_NS
        self._left_steps = self._right_steps = 0.0
        self._left_speed = self._right_speed = 0.0
        self._commands: deque[tuple[int, float, float]] = deque()
        self._slips: list[float] = []
        self._slip_slot = -1
        self._left_grip = self._right_grip = 1.0
        self._unwrapper = StepUnwrapper()

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        sent = self._geometry.sendable(speeds)
        self.run_wheels(sent, t_ns)
        if self._obeys_for_s < math.inf:
            self._expires_ns = t_ns + round(max(self._obeys_for_s * 1e9, self._latency_ns))
        return sent

    def run_wheels(self, speeds: WheelSpeeds, t_ns: int) -> None:
        """Turn the wheels at exactly these speeds, after the latency, until they are told otherwise."""
        self._advance(t_ns)
        self._set_speeds_at(t_ns + self._latency_ns, speeds)

    def _set_speeds_at(self, t_ns: int, speeds: WheelSpeeds) -> None:
        self._commands.append((t_ns, speeds.left_steps_per_s, speeds.right_steps_per_s))
        self._next_ns = min(self._next_ns, t_ns)

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        ahead_s = self._advance(t_ns)
        left = math.floor(self._left_steps + self._left_speed * ahead_s)
        right = math.floor(self._right_steps + self._right_speed * ahead_s)
        return self._unwrapper.unwrap(left & 0xFFFF, right & 0xFFFF)

    def close(self) -> None:
        self._commands.clear()
        self._obey()
        self.drive(STOPPED, self._latest_ns)

    def truth(self, t_ns: int) -> Pose:
        """Where the robot really is."""
        ahead_s = self._advance(t_ns)
        if not (ahead_s and self._rolling):
            return Pose(self._x_m, self._y_m, wrap_angle_rad(self._theta_rad))
        x_m, y_m, theta_rad = self._arc(ahead_s)
        if self._confined:
            x_m, y_m = self._clamped(x_m, y_m)
        return Pose(x_m, y_m, wrap_angle_rad(theta_rad))

    def place(self, pose: Pose) -> None:
        """Put the robot somewhere by hand, at the time of the last call; its wheels go on as they were."""
        self._move_to(self._latest_ns)
        self._x_m, self._y_m, self._theta_rad = pose.x_m, pose.y_m, pose.theta_rad
        self._confined = self._inside(pose)
        self._touching = False

    def _advance(self, t_ns: int) -> float:
        """Bring the state to the last fixed instant up to `t_ns`; return the seconds left from there."""
        if t_ns < self._latest_ns:
            raise ValueError(f"time went back from {self._latest_ns} ns to {t_ns} ns: ask in order of time")
        if not self._started:
            self._started = True
            self._t_ns = t_ns
        self._latest_ns = t_ns
        if self._expires_ns < t_ns:
            self._set_speeds_at(self._expires_ns, STOPPED)
            self._expires_ns = _NEVER_NS
        while self._next_ns <= t_ns:
            self._move_to(self._next_ns)
            self._obey()
        return (t_ns - self._t_ns) * 1e-9

    def _obey(self) -> None:
        """Take over the commands that are due, and find the next fixed instant."""
        commands = self._commands
        while commands and commands[0][0] <= self._t_ns:
            _, self._left_speed, self._right_speed = commands.popleft()
            self._rolling = self._left_speed != 0.0 or self._right_speed != 0.0
        self._next_ns = commands[0][0] if commands else _NEVER_NS
        if self._rolling:
            slot_end_ns = (self._t_ns // SLIP_SLOT_NS + 1) * SLIP_SLOT_NS
            self._next_ns = min(self._next_ns, slot_end_ns)

    def _move_to(self, t_ns: int) -> None:
        duration_s = (t_ns - self._t_ns) * 1e-9
        if self._rolling and duration_s:
            x_m, y_m, self._theta_rad = self._arc(duration_s)
            self._left_steps += self._left_speed * duration_s
            self._right_steps += self._right_speed * duration_s
            self._x_m, self._y_m = self._clamped(x_m, y_m) if self._confined else (x_m, y_m)
            touching = self._x_m != x_m or self._y_m != y_m
            self.contacts += touching and not self._touching
            self._touching = touching
        self._t_ns = t_ns

    def _arc(self, duration_s: float) -> tuple[float, float, float]:
        """The pose after driving on within the present slot; the chord of the arc is exact."""
        slot = self._t_ns // SLIP_SLOT_NS
        if slot != self._slip_slot:
            self._slip_slot = slot
            self._draw_slips()
        left_m = self._left_speed * self._left_step_m * self._left_grip * duration_s
        right_m = self._right_speed * self._right_step_m * self._right_grip * duration_s
        half_turn_rad = 0.5 * (right_m - left_m) / self._track_m
        chord_m = 0.5 * (left_m + right_m)
        if half_turn_rad:
            chord_m *= math.sin(half_turn_rad) / half_turn_rad
        heading_rad = self._theta_rad + half_turn_rad
        return (
            self._x_m + chord_m * math.cos(heading_rad),
            self._y_m + chord_m * math.sin(heading_rad),
            heading_rad + half_turn_rad,
        )

    def _draw_slips(self) -> None:
        if not self._slips:
            self._slips = self._rng.normal(1.0, self._slip_sd, _SLIPS_DRAWN_AT_ONCE).tolist()
        self._left_grip, self._right_grip = self._slips.pop(), self._slips.pop()

    def _inside(self, pose: Pose) -> bool:
        return self._clamped(pose.x_m, pose.y_m) == (pose.x_m, pose.y_m)

    def _clamped(self, x_m: float, y_m: float) -> tuple[float, float]:
        return (
            min(max(x_m, self._west_m), self._east_m),
            min(max(y_m, self._south_m), self._north_m),
        )
