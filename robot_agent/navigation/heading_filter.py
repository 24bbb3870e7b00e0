"""A Kalman filter of the heading that also learns each wheel's true size.

Wheels of slightly different size make a robot drive in curves: 1.5 % is 2 degrees a second at 0.10 m/s.
A filter that only averages the tracker's headings lags behind such a drift. This one has the state
(heading, left wheel's scale, right wheel's scale), and so can average for long without lagging.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HeadingSettings:
    """How uncertain the heading, the wheels and the tracker are, as standard deviations."""

    tracker_sd_rad: float = 0.0175
    """1 degree, twice the experiment file's: chosen, as a tracker's markers may be close together."""
    slip_sd_rad_per_sqrt_m: float = 0.03
    """Random-walk growth of the heading's error with the distance that the wheels roll."""

    scale_sd: float = 0.015
    """Relative error of each wheel's nominal size."""

    scale_drift_sd_per_sqrt_m: float = 0.0003
    """Chosen: a wheel keeps its size, but the filter must not freeze in the hours of a run."""
    smallest_sd_rad: float = 0.004
    """The filter never trusts itself more than this, so that an unnoticed push is corrected soon."""


class HeadingFilter:
    """Covariance and gains of (heading, left scale, right scale); the state itself lives in the odometry."""

    def __init__(self, settings: HeadingSettings, wheel_base_m: float) -> None:
        self._track_m = wheel_base_m
        self._tracker_variance = settings.tracker_sd_rad**2
        self._slip_variance_per_m = settings.slip_sd_rad_per_sqrt_m**2
        self._scale_variance_per_m = settings.scale_drift_sd_per_sqrt_m**2
        self._smallest_variance = settings.smallest_sd_rad**2
        self._left = self._right = settings.scale_sd**2
        self._left_right = 0.0
        self.restart()

    def restart(self) -> None:
        """The heading has just been set from one fix; what is known of the wheels stays."""
        self._heading = self._tracker_variance
        self._heading_left = self._heading_right = 0.0

    def predict(self, left_m: float, right_m: float) -> None:
        """The wheels rolled: scale errors leak into the heading, and slip adds to it."""
        a, b = -left_m / self._track_m, right_m / self._track_m
        rolled_m = 0.5 * (abs(left_m) + abs(right_m))
        to_left = a * self._left + b * self._left_right
        to_right = a * self._left_right + b * self._right
        self._heading += 2.0 * (a * self._heading_left + b * self._heading_right) + a * to_left + b * to_right
        self._heading += self._slip_variance_per_m * rolled_m
        self._heading_left += to_left
        self._heading_right += to_right
        self._left += self._scale_variance_per_m * rolled_m
        self._right += self._scale_variance_per_m * rolled_m

    def update(self, left_since_m: float, right_since_m: float) -> tuple[float, float, float]:
        """Take in a heading measured when the wheels had still to roll the given distances.

        Returns the gains: what to add to the heading, the left and the right scale per radian by which the
        measured heading exceeds the expected one.
        """
        self._heading = max(self._heading, self._smallest_variance)
        a, b = left_since_m / self._track_m, -right_since_m / self._track_m
        heading = self._heading + a * self._heading_left + b * self._heading_right
        left = self._heading_left + a * self._left + b * self._left_right
        right = self._heading_right + a * self._left_right + b * self._right
        variance = heading + a * left + b * right + self._tracker_variance
        gains = heading / variance, left / variance, right / variance
        self._heading -= gains[0] * heading
        self._heading_left -= gains[0] * left
        self._heading_right -= gains[0] * right
        self._left -= gains[1] * left
        self._left_right -= gains[1] * right
        self._right -= gains[2] * right
        return gains
