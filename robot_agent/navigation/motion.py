"""From cell to cell: turn in place towards the target, drive with heading correction, brake, settle.

The controller runs at about 10 Hz and its commands take effect late. So it plans from where the robot
will be when the command takes effect, and chooses each speed such that whole control periods cover what
remains: braking ends on the target and not a period beyond it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds
from swarm.geometry import Pose, wrap_angle_rad


@dataclass(frozen=True, slots=True)
class MotionSettings:
    """How a robot moves. The defaults take 2.2 to 2.5 s for a move between cells of 12 cm."""

    drive_speed_m_per_s: float = 0.10
    """With turning 2.4 s a move, as in the paper's 10 hours for 15,000 moves; 0.129 is the most."""

    turn_speed_rad_per_s: float = 3.0
    """Of the 4.9 that the wheels can: 0.5 s for a right angle."""

    drive_acceleration_m_per_s2: float = 1.0
    turn_acceleration_rad_per_s2: float = 30.0
    """Chosen: full speed within one control period; a gentler start would take longer."""

    period_s: float = 0.1
    """Time from one step of the controller to the next."""

    latency_s: float = 0.06
    """Time from a command to its effect."""

    aligned_rad: float = math.radians(4.0)
    """Driving starts when the heading is this close to the target's direction."""

    astray_rad: float = math.radians(25.0)
    """A drive whose direction is this far off becomes a turn again."""

    landing: float = 0.8
    """Part of the remaining angle that a last period of turning covers. All of it would make the turn
    oscillate if the true latency is shorter than the one above."""

    heading_gain_per_s: float = 4.0
    """Chosen: corrects 40 % of an error in a period; not all of it, since commands take effect late."""

    hold_heading_within_m: float = 0.03
    """This close to the target its direction is noise: the heading is held."""

    reached_m: float = 0.001
    """A drive ends when the target is no further ahead than this."""

    tolerance_m: float = 0.004
    """A leg that ends further than this from its target is approached once more."""

    tolerance_rad: float = math.radians(1.5)
    """Of a turn without a drive; chosen above the heading's error."""

    attempts: int = 3
    """After so many approaches of one leg the robot is content with where it stands."""

    pause_s: float = 0.2
    """Rest after the wheels have stopped; part of the move's time."""

    stale_pose_s: float = 1.0
    """Without a fix for longer than this the robot stops and waits; until then it goes by odometry."""


class Phase(Enum):
    """What the robot is doing."""

    IDLE = auto()
    TURN = auto()
    DRIVE = auto()
    SETTLE = auto()
    ARRIVED = auto()


class Motion:
    """Takes the robot to one place or heading after another.

    Call `step` once a control period and send what it returns.
    """

    def __init__(self, settings: MotionSettings, geometry: EpuckGeometry) -> None:
        self.phase = Phase.IDLE
        self.stalled = False
        """Whether the last step stopped the robot for want of a fresh pose."""
        self._settings = settings
        self._geometry = geometry
        self._place: tuple[float, float] | None = None
        self._heading_rad = 0.0
        self._backwards = False
        self._attempts = 0
        self._rest_until_ns = 0
        self._forward_m_per_s = 0.0
        self._turn_rad_per_s = 0.0

    @property
    def arrived(self) -> bool:
        """Whether the last leg has ended and the robot rests."""
        return self.phase is Phase.ARRIVED

    def go_to(self, x_m: float, y_m: float) -> None:
        """Start a leg to a place in the arena frame."""
        self._place = (x_m, y_m)
        self._start()

    def turn_to(self, theta_rad: float) -> None:
        """Start a turn in place to a heading in the arena frame."""
        self._place = None
        self._heading_rad = theta_rad
        self._start()

    def stop(self) -> None:
        """Give up the leg; the next step stops the wheels."""
        self._place = None
        self.phase = Phase.IDLE

    def step(self, pose: Pose | None, t_ns: int, age_s: float = 0.0) -> WheelSpeeds:
        """The wheel speeds for the next control period.

        `pose` is the estimate at `t_ns`, and `age_s` the time since the fix that it rests on. Without a
        pose, or with a stale one, the robot stands and the leg goes on when fixes return.
        """
        self.stalled = pose is None or age_s > self._settings.stale_pose_s
        if pose is None or self.stalled or self.phase in (Phase.IDLE, Phase.ARRIVED):
            return self._command(0.0, 0.0)
        ahead = self._at_effect(pose)
        if self.phase is Phase.SETTLE:
            return self._settle(pose, t_ns)
        if self.phase is Phase.DRIVE and self._is_astray(ahead):
            self.phase = Phase.TURN
        if self.phase is Phase.TURN and not self._is_there(ahead):
            if turn_rad_per_s := self._turn(ahead):
                return self._command(0.0, turn_rad_per_s)
            self.phase = Phase.DRIVE
        if self.phase is Phase.DRIVE and (forward_m_per_s := self._drive(ahead)):
            return self._command(forward_m_per_s, self._correction_rad_per_s(ahead))
        self._rest(t_ns)
        return self._command(0.0, 0.0)

    def _start(self) -> None:
        self._attempts = 0
        self._approach()

    def _approach(self) -> None:
        self._attempts += 1
        self._backwards = False
        self.phase = Phase.TURN

    def _command(self, forward_m_per_s: float, turn_rad_per_s: float) -> WheelSpeeds:
        self._forward_m_per_s, self._turn_rad_per_s = forward_m_per_s, turn_rad_per_s
        if forward_m_per_s == 0.0 and turn_rad_per_s == 0.0:
            return STOPPED
        return self._geometry.wheel_speeds(forward_m_per_s, turn_rad_per_s)

    def _at_effect(self, pose: Pose) -> Pose:
        """Where the robot will be when the next command takes effect: the last one holds until then."""
        latency_s = self._settings.latency_s
        half_turn_rad = 0.5 * self._turn_rad_per_s * latency_s
        heading_rad = pose.theta_rad + half_turn_rad
        driven_m = self._forward_m_per_s * latency_s
        return Pose(
            pose.x_m + driven_m * math.cos(heading_rad),
            pose.y_m + driven_m * math.sin(heading_rad),
            heading_rad + half_turn_rad,
        )

    def _turn(self, ahead: Pose) -> float:
        """Turning speed towards the target; 0 when the robot is aligned with its place and may drive."""
        settings = self._settings
        if self._place is not None:
            self._heading_rad = self._direction_rad(ahead, self._place)
        error_rad = wrap_angle_rad(self._heading_rad - ahead.theta_rad)
        if self._place is not None and abs(error_rad) <= settings.aligned_rad:
            return 0.0
        return _approach_speed(
            error_rad,
            self._turn_rad_per_s,
            settings.turn_speed_rad_per_s,
            settings.turn_acceleration_rad_per_s2,
            settings.period_s,
            settings.landing,
        )

    def _direction_rad(self, ahead: Pose, place: tuple[float, float]) -> float:
        """The heading in which to drive to a place; the robot backs up to one that it has just passed."""
        dx_m, dy_m = place[0] - ahead.x_m, place[1] - ahead.y_m
        bearing_rad = math.atan2(dy_m, dx_m)
        near = math.hypot(dx_m, dy_m) < self._settings.hold_heading_within_m
        self._backwards = near and abs(wrap_angle_rad(bearing_rad - ahead.theta_rad)) > math.pi / 2
        return bearing_rad + math.pi if self._backwards else bearing_rad

    def _is_astray(self, ahead: Pose) -> bool:
        """Aim the drive anew; whether its direction is so far off that the robot must turn in place."""
        assert self._place is not None
        dx_m, dy_m = self._place[0] - ahead.x_m, self._place[1] - ahead.y_m
        if not self._backwards and math.hypot(dx_m, dy_m) > self._settings.hold_heading_within_m:
            self._heading_rad = math.atan2(dy_m, dx_m)
        return abs(wrap_angle_rad(self._heading_rad - ahead.theta_rad)) > self._settings.astray_rad

    def _drive(self, ahead: Pose) -> float:
        """Forward speed towards the target; 0 when it is reached."""
        settings = self._settings
        assert self._place is not None
        dx_m, dy_m = self._place[0] - ahead.x_m, self._place[1] - ahead.y_m
        left_m = dx_m * math.cos(ahead.theta_rad) + dy_m * math.sin(ahead.theta_rad)
        if abs(left_m) < settings.reached_m or (left_m < 0.0) is not self._backwards:
            return 0.0
        return _approach_speed(
            left_m,
            self._forward_m_per_s,
            settings.drive_speed_m_per_s,
            settings.drive_acceleration_m_per_s2,
            settings.period_s,
        )

    def _correction_rad_per_s(self, ahead: Pose) -> float:
        return self._settings.heading_gain_per_s * wrap_angle_rad(self._heading_rad - ahead.theta_rad)

    def _rest(self, t_ns: int) -> None:
        self.phase = Phase.SETTLE
        self._rest_until_ns = t_ns + round(self._settings.pause_s * 1e9)

    def _settle(self, pose: Pose, t_ns: int) -> WheelSpeeds:
        """Rest, then end the leg, or approach once more if the robot stands too far off."""
        # Half a period of grace: a clock that ticks a little early must not cost a whole period.
        if t_ns + round(0.5e9 * self._settings.period_s) >= self._rest_until_ns:
            if self._attempts >= self._settings.attempts or self._is_there(pose):
                self.phase = Phase.ARRIVED
            else:
                self._approach()
        return self._command(0.0, 0.0)

    def _is_there(self, pose: Pose) -> bool:
        if self._place is None:
            error_rad = wrap_angle_rad(self._heading_rad - pose.theta_rad)
            return abs(error_rad) <= self._settings.tolerance_rad
        return math.hypot(self._place[0] - pose.x_m, self._place[1] - pose.y_m) <= self._settings.tolerance_m


def _approach_speed(
    left: float, speed: float, fastest: float, acceleration: float, period_s: float, landing: float = 1.0
) -> float:
    """The speed with which to cover the signed distance `left` (m or rad), now moving with `speed`.

    Slowing by at most `acceleration` from period to period, a speed v needs v^2 / 2a + v T / 2 to end; this
    is the discrete form of braking by sqrt(2 a d). The last period covers the part `landing` of what is left.
    """
    distance = abs(left)
    per_period = acceleration * period_s
    braking = math.sqrt(0.25 * per_period * per_period + 2.0 * acceleration * distance) - 0.5 * per_period
    towards = speed if left > 0.0 else -speed
    gathered = max(towards, 0.0) + per_period
    return math.copysign(min(fastest, gathered, braking, landing * distance / period_s), left)
