"""What the agent asks of a robot's body: drive two wheels, count their steps, let go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable


@dataclass(frozen=True, slots=True)
class WheelSpeeds:
    """Speeds of the two wheels; forward is positive."""

    left_steps_per_s: float
    right_steps_per_s: float


@dataclass(frozen=True, slots=True)
class WheelSteps:
    """Steps counted by the two wheels, unwrapped: they only make sense as differences."""

    left: int
    right: int


STOPPED = WheelSpeeds(0.0, 0.0)


@runtime_checkable
class Body(Protocol):
    """A robot's wheels. A new driver is one class with these methods; `tests/contracts.py` examines it.

    `t_ns` is the run's time and never goes back from one call to the next.
    """

    def drive(self, speeds: WheelSpeeds, t_ns: int) -> WheelSpeeds:
        """Send wheel speeds, clipped to what the motors can do; return those really sent.

        Raises ValueError, and sends nothing, if a speed is not finite.
        """

    def wheel_steps(self, t_ns: int) -> WheelSteps:
        """Read the step counters. Ask at least every 30 s: they wrap after 32 s at full speed."""

    def close(self) -> None:
        """Switch the motors off and let the robot go; a second call does nothing."""


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
