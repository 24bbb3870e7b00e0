"""The robot's own pose: late, noisy tracker fixes fused with wheel odometry."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from robot_agent.drivers.body import WheelSteps
from robot_agent.drivers.epuck import EpuckGeometry
from robot_agent.heading import HeadingFilter, HeadingSettings
from robot_agent.odometry import Odometry, Reckoned
from swarm.geometry import Pose, wrap_angle_rad


@dataclass(frozen=True, slots=True)
class FusionSettings:
    """How far to trust the tracker and the wheels."""

    tracker_sd_m: float = 0.001
    drift_sd_m_per_sqrt_m: float = 0.005
    """Random-walk growth of the position's error with the distance driven."""

    smallest_sd_m: float = 0.0003
    heading: HeadingSettings = field(default_factory=HeadingSettings)
    memory_s: float = 2.0
    """The oldest fix that can still be used."""

    far_m: float = 0.06
    far_rad: float = 0.6
    """A fix further than this from the estimate is not believed at once."""

    agree_m: float = 0.02
    agree_rad: float = 0.2
    fixes_to_believe: int = 3
    """So many far fixes in a row that agree with each other mean that the robot was displaced."""

    largest_scale_error: float = 0.05


class PoseEstimator:
    """Where the robot is, in the arena frame.

    Odometry gives a smooth path in a frame of its own; each fix corrects where that frame lies in the
    arena. A late fix is compared with the odometry of its own time, so that lateness costs nothing.
    """

    def __init__(self, geometry: EpuckGeometry, settings: FusionSettings | None = None) -> None:
        self.displaced = False
        """Fixes agree that the robot is elsewhere: it was carried by hand. Stays true until `reset`."""
        self._settings = settings or FusionSettings()
        self._odometry = Odometry(geometry, self._settings.memory_s)
        self._heading = HeadingFilter(self._settings.heading, geometry.track_m)
        self._variance = 0.0
        self._frame: Pose | None = None
        self._fixed_ns = 0
        self._heard_ns: int | None = None
        self._far_frame: Pose | None = None
        self._far_fixes = 0

    def reset(self) -> None:
        """Forget the place (the wheels' learned sizes are kept); the next fix gives a new one."""
        self._frame = None
        self._forget_far()
        self.displaced = False

    def odometry(self, steps: WheelSteps, t_ns: int) -> None:
        """Take in the wheels' step counts; call this before `fix` in a tick."""
        left_m, right_m = self._odometry.advance(steps, t_ns)
        if left_m or right_m:
            self._heading.predict(left_m, right_m)
            self._variance += self._settings.drift_sd_m_per_sqrt_m**2 * 0.5 * abs(left_m + right_m)

    def fix(self, pose: Pose, t_ns: int) -> None:
        """Take in the pose that the tracker measured at `t_ns`.

        Passed over are a fix that is not newer than the last one, older than the memory, or from before
        the first odometry.
        """
        then = self._odometry.at(t_ns)
        if then is None or (self._heard_ns is not None and t_ns <= self._heard_ns):
            return
        self._heard_ns = t_ns
        if self._frame is None:
            self._start(pose, then)
        elif self._is_near(pose, self._frame, then, self._settings.far_m, self._settings.far_rad):
            self._correct(pose, then)
        else:
            self._doubt(pose, then)

    def pose(self, t_ns: int) -> Pose | None:
        """The estimate at a time within the memory (a camera frame's, say); None before the first fix.

        For a time after the newest odometry it is the pose at that odometry.
        """
        state = self._odometry.at(t_ns)
        if self._frame is None or state is None:
            return None
        return _placed(self._frame, state)

    def age_s(self, t_ns: int) -> float:
        """How long ago the last believed fix was measured; infinite without one."""
        return math.inf if self._frame is None else (t_ns - self._fixed_ns) * 1e-9

    def _start(self, pose: Pose, then: Reckoned) -> None:
        self._frame = _frame_of(pose, then)
        self._fixed_ns = then.t_ns
        self._variance = self._settings.tracker_sd_m**2
        self._heading.restart()
        self._forget_far()

    def _correct(self, pose: Pose, then: Reckoned) -> None:
        now = self._odometry.newest
        assert self._frame is not None
        assert now is not None
        expected = _placed(self._frame, then)
        surprise_rad = wrap_angle_rad(pose.theta_rad - expected.theta_rad)
        gains = self._heading.update(now.left_m - then.left_m, now.right_m - then.right_m)
        self._scale_wheels(gains[1] * surprise_rad, gains[2] * surprise_rad)
        gain = self._position_gain()
        corrected = Pose(
            expected.x_m + gain * (pose.x_m - expected.x_m),
            expected.y_m + gain * (pose.y_m - expected.y_m),
            expected.theta_rad + gains[0] * surprise_rad,
        )
        self._frame = _frame_of(corrected, then)
        self._fixed_ns = then.t_ns
        self._forget_far()

    def _position_gain(self) -> float:
        self._variance = max(self._variance, self._settings.smallest_sd_m**2)
        gain = self._variance / (self._variance + self._settings.tracker_sd_m**2)
        self._variance *= 1.0 - gain
        return gain

    def _scale_wheels(self, left: float, right: float) -> None:
        low, high = 1.0 - self._settings.largest_scale_error, 1.0 + self._settings.largest_scale_error
        odometry = self._odometry
        odometry.left_scale = min(max(odometry.left_scale + left, low), high)
        odometry.right_scale = min(max(odometry.right_scale + right, low), high)

    def _doubt(self, pose: Pose, then: Reckoned) -> None:
        """A fix far from the estimate: an outlier, unless others agree with it."""
        settings, before = self._settings, self._far_frame
        agrees = before and self._is_near(pose, before, then, settings.agree_m, settings.agree_rad)
        self._far_fixes = self._far_fixes + 1 if agrees else 1
        self._far_frame = _frame_of(pose, then)
        if self._far_fixes >= settings.fixes_to_believe:
            self._start(pose, then)
            self.displaced = True

    def _forget_far(self) -> None:
        self._far_frame, self._far_fixes = None, 0

    @staticmethod
    def _is_near(pose: Pose, frame: Pose, then: Reckoned, limit_m: float, limit_rad: float) -> bool:
        expected = _placed(frame, then)
        turned_rad = abs(wrap_angle_rad(pose.theta_rad - expected.theta_rad))
        return turned_rad <= limit_rad and pose.distance_m(expected) <= limit_m


def _placed(frame: Pose, state: Reckoned) -> Pose:
    """A dead-reckoned state in the arena, when `frame` is the arena pose of the odometry's frame."""
    cos, sin = math.cos(frame.theta_rad), math.sin(frame.theta_rad)
    return Pose(
        frame.x_m + cos * state.x_m - sin * state.y_m,
        frame.y_m + sin * state.x_m + cos * state.y_m,
        wrap_angle_rad(frame.theta_rad + state.theta_rad),
    )


def _frame_of(pose: Pose, state: Reckoned) -> Pose:
    """The arena pose of the odometry's frame that places a state at a pose."""
    theta_rad = pose.theta_rad - state.theta_rad
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    return Pose(
        pose.x_m - cos * state.x_m + sin * state.y_m,
        pose.y_m - sin * state.x_m - cos * state.y_m,
        theta_rad,
    )
