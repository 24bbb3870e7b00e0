"""The e-puck's dimensions and the arithmetic of two wheels and their step counters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple


class WheelSpeeds(NamedTuple):
    """Speeds of the two wheels; forward is positive."""

    left_steps_per_s: float
    right_steps_per_s: float


class WheelSteps(NamedTuple):
    """Steps counted by the two wheels, unwrapped: they only make sense as differences."""

    left: int
    right: int


STOPPED = WheelSpeeds(0.0, 0.0)


class StepUnwrapper:
    """Turns readings of two 16-bit step counters into counts that never wrap."""

    def __init__(self) -> None:
        self._left: int | None = None
        self._right: int | None = None

    def unwrap(self, left: int, right: int) -> WheelSteps:
        """The counts for two raw readings, signed or unsigned."""
        self._left = _continued(self._left, left)
        self._right = _continued(self._right, right)
        return WheelSteps(self._left, self._right)


def _continued(count: int | None, reading: int) -> int:
    """The count nearest to the last one that a 16-bit counter shows as `reading`."""
    if count is None:
        return reading
    return count + ((reading - count + 0x8000) & 0xFFFF) - 0x8000


STEP_M = 0.1288e-3
"""A wheel of 41 mm turns once in 1000 steps; the simulated robots' wheels too."""
NOMINAL_DIAMETER_M = 0.041


@dataclass(frozen=True, slots=True)
class EpuckGeometry:
    """Dimensions of an e-puck. Defaults are the manufacturer's; the track should be calibrated.

    Wheels of 41 mm turn once in 1000 steps. Published tracks go from 52 to 57 mm, so each robot may have
    its own.
    """

    step_m: float = STEP_M
    wheel_base_m: float = 0.053
    max_steps_per_s: float = 1000.0
    body_radius_m: float = 0.035

    @classmethod
    def calibrated(cls, wheel_diameter_m: float, wheel_base_m: float) -> EpuckGeometry:
        """The geometry of one real robot."""
        return cls(step_m=STEP_M * (wheel_diameter_m / NOMINAL_DIAMETER_M), wheel_base_m=wheel_base_m)

    @staticmethod
    def diameter_m(step_m: float) -> float:
        """The diameter of a wheel with steps of this length."""
        return NOMINAL_DIAMETER_M * (step_m / STEP_M)

    def wheel_speeds(self, forward_m_per_s: float, turn_rad_per_s: float) -> WheelSpeeds:
        """The wheel speeds of a differential drive for a forward and a counter-clockwise turning speed."""
        half_turn_m_per_s = 0.5 * self.wheel_base_m * turn_rad_per_s
        return WheelSpeeds(
            (forward_m_per_s - half_turn_m_per_s) / self.step_m,
            (forward_m_per_s + half_turn_m_per_s) / self.step_m,
        )

    def sendable(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """The nearest speeds that a robot accepts: whole steps a second, within the limit.

        Both wheels are slowed by one factor, so that the robot keeps to its curve. Raises ValueError if a
        speed is not finite.
        """
        left, right = speeds.left_steps_per_s, speeds.right_steps_per_s
        fastest = max(abs(left), abs(right))
        if not math.isfinite(left) or not math.isfinite(right):
            raise ValueError(f"wheel speeds must be finite, got {left} and {right} steps/s")
        if fastest > self.max_steps_per_s:
            factor = self.max_steps_per_s / fastest
            left, right = left * factor, right * factor
        return WheelSpeeds(float(round(left)), float(round(right)))
