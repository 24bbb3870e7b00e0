"""The robot's own pose: late, noisy tracker fixes fused with wheel odometry."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSteps
from robot_agent.navigation.heading_filter import HeadingFilter, HeadingSettings
from robot_agent.navigation.odometry import Odometry, Reckoned
from swarm.geometry import Pose, wrap_angle_rad

PoseAt = Callable[[int], Pose | None]
"""Where the robot itself was at a time in nanoseconds; None if that is not known (any more)."""


@dataclass(frozen=True, slots=True)
class FusionSettings:
    """How far to trust the tracker and the wheels."""

    tracker_sd_m: float = 0.001
    """As the experiment file's [tracker] noise_m has it."""
    drift_sd_m_per_sqrt_m: float = 0.005
    """Random-walk growth of the position's error with the distance driven; chosen above the simulated
    slip, as a real floor is less even."""

    smallest_sd_m: float = 0.0003
    """Chosen: a third of the tracker's noise; a filter surer than this would not notice a push."""

    heading: HeadingSettings = field(default_factory=HeadingSettings)
    memory_s: float = 2.0
    """The oldest fix that can still be used."""

    far_m: float = 0.06
    far_rad: float = 0.6
    """A fix further than this from the estimate is not believed at once: half a cell, and 34 degrees."""

    agree_m: float = 0.02
    agree_rad: float = 0.2
    fixes_to_believe: int = 3
    """So many far fixes in a row that agree with each other mean that the robot was displaced: within the
    0.013 m that it drives from one to the next, and some noise."""

    largest_scale_error: float = 0.05
    """Chosen: three times the 1.5 % by which wheels differ; a filter that learns more has learnt a push."""


class _Frame(NamedTuple):
    """The arena pose of the frame in which the odometry runs."""

    x_m: float
    y_m: float
    theta_rad: float
    cos: float
    sin: float

    def place(self, state: Reckoned) -> tuple[float, float, float]:
        """A dead-reckoned state in the arena: x_m, y_m, and theta_rad not wrapped."""
        return (
            self.x_m + self.cos * state.x_m - self.sin * state.y_m,
            self.y_m + self.sin * state.x_m + self.cos * state.y_m,
            self.theta_rad + state.theta_rad,
        )


def _frame_that_places(state: Reckoned, x_m: float, y_m: float, theta_rad: float) -> _Frame:
    """The frame in which a dead-reckoned state lies at the given pose."""
    frame_rad = theta_rad - state.theta_rad
    cos, sin = math.cos(frame_rad), math.sin(frame_rad)
    return _Frame(
        x_m - cos * state.x_m + sin * state.y_m,
        y_m - sin * state.x_m - cos * state.y_m,
        frame_rad,
        cos,
        sin,
    )


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
        self._heading = HeadingFilter(self._settings.heading, geometry.wheel_base_m)
        self._tracker_variance = self._settings.tracker_sd_m**2
        self._smallest_variance = self._settings.smallest_sd_m**2
        self._drift_variance_per_m = self._settings.drift_sd_m_per_sqrt_m**2
        self._variance = 0.0
        self._frame: _Frame | None = None
        self._fixed_ns = 0
        self._heard_ns: int | None = None
        self._far_frame: _Frame | None = None
        self._far_fixes = 0

    def reset(self) -> None:
        """Forget the place (the wheels' learned sizes are kept); the next fix gives a new one."""
        self._frame = None
        self._far_fixes = 0
        self.displaced = False

    def odometry(self, steps: WheelSteps, t_ns: int) -> None:
        """Take in the wheels' step counts; call this before `fix` in a tick."""
        left_m, right_m = self._odometry.advance(steps, t_ns)
        if left_m or right_m:
            self._heading.predict(left_m, right_m)
            self._variance += self._drift_variance_per_m * 0.5 * abs(left_m + right_m)

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
            return
        surprise = _surprise(pose, self._frame, then)
        if self._is_far(surprise):
            self._doubt(pose, then)
        else:
            self._correct(pose, then, surprise)

    def pose(self, t_ns: int) -> Pose | None:
        """The estimate at a time within the memory (a camera frame's, say); None before the first fix.

        For a time after the newest odometry it is the pose at that odometry.
        """
        state = self._odometry.at(t_ns)
        if self._frame is None or state is None:
            return None
        x_m, y_m, theta_rad = self._frame.place(state)
        return Pose(x_m, y_m, wrap_angle_rad(theta_rad))

    def age_s(self, t_ns: int) -> float:
        """How long ago the last believed fix was measured; infinite without one."""
        return math.inf if self._frame is None else (t_ns - self._fixed_ns) * 1e-9

    def _start(self, pose: Pose, then: Reckoned) -> None:
        self._frame = _frame_that_places(then, pose.x_m, pose.y_m, pose.theta_rad)
        self._fixed_ns = then.t_ns
        self._variance = self._tracker_variance
        self._heading.restart()
        self._far_fixes = 0

    def _correct(self, pose: Pose, then: Reckoned, surprise: Surprise) -> None:
        dx_m, dy_m, turned_rad = surprise
        now = self._odometry.newest
        heading, left, right = self._heading.update(now.left_m - then.left_m, now.right_m - then.right_m)
        self._scale_wheels(left * turned_rad, right * turned_rad)
        kept = 1.0 - self._position_gain()
        x_m, y_m = pose.x_m - kept * dx_m, pose.y_m - kept * dy_m
        theta_rad = pose.theta_rad - (1.0 - heading) * turned_rad
        self._frame = _frame_that_places(then, x_m, y_m, theta_rad)
        self._fixed_ns = then.t_ns
        self._far_fixes = 0

    def _position_gain(self) -> float:
        variance = max(self._variance, self._smallest_variance)
        gain = variance / (variance + self._tracker_variance)
        self._variance = (1.0 - gain) * variance
        return gain

    def _scale_wheels(self, left: float, right: float) -> None:
        error, odometry = self._settings.largest_scale_error, self._odometry
        odometry.left_scale = min(max(odometry.left_scale + left, 1.0 - error), 1.0 + error)
        odometry.right_scale = min(max(odometry.right_scale + right, 1.0 - error), 1.0 + error)

    def _is_far(self, surprise: Surprise) -> bool:
        dx_m, dy_m, turned_rad = surprise
        return math.hypot(dx_m, dy_m) > self._settings.far_m or abs(turned_rad) > self._settings.far_rad

    def _doubt(self, pose: Pose, then: Reckoned) -> None:
        """A fix far from the estimate: an outlier, unless others agree with it."""
        agrees = self._far_fixes > 0 and self._agrees_with_far(pose, then)
        self._far_fixes = self._far_fixes + 1 if agrees else 1
        self._far_frame = _frame_that_places(then, pose.x_m, pose.y_m, pose.theta_rad)
        if self._far_fixes >= self._settings.fixes_to_believe:
            self._start(pose, then)
            self.displaced = True

    def _agrees_with_far(self, pose: Pose, then: Reckoned) -> bool:
        assert self._far_frame is not None
        dx_m, dy_m, turned_rad = _surprise(pose, self._far_frame, then)
        return (
            math.hypot(dx_m, dy_m) <= self._settings.agree_m and abs(turned_rad) <= self._settings.agree_rad
        )


Surprise = tuple[float, float, float]
"""By how much a fix exceeds what was expected: dx_m, dy_m, and the angle in radians."""


def _surprise(pose: Pose, frame: _Frame, then: Reckoned) -> Surprise:
    x_m, y_m, theta_rad = frame.place(then)
    return pose.x_m - x_m, pose.y_m - y_m, wrap_angle_rad(pose.theta_rad - theta_rad)
