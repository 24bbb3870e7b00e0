"""What a link to a real robot does: one exchange, commands there and readings back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from robot_agent.drivers.motors import StepperMotors

SENSORS = 8
HIGHEST_RAW = 4095
"""Infra-red readings have 12 bits: a higher one is no reading."""


class LinkError(Exception):
    """The link is gone: it has to be opened again."""


class ReplyError(Exception):
    """The robot's answer did not come, or is not one; the next may be good."""


@dataclass(frozen=True, slots=True)
class Actuators:
    """What a robot is told. `lights` has bits 0 to 7 for the ring, 8 for the body, 9 for the front."""

    left: int = 0
    right: int = 0
    lights: int = 0


@dataclass(frozen=True, slots=True)
class Reading:
    """What a robot says: raw 16-bit step counters, infra-red echoes, volts (0: unknown), selector (-1)."""

    left: int
    right: int
    proximity: tuple[int, ...] = (0,) * SENSORS
    battery_v: float = 0.0
    selector: int = -1

    def checked(self) -> Reading:
        """The reading itself; ReplyError if a sensor shows what it cannot."""
        if any(not 0 <= echo <= HIGHEST_RAW for echo in self.proximity):
            raise ReplyError(f"proximity {self.proximity} has more than 12 bits")
        if not 0 <= self.battery_v <= 5.5:
            raise ReplyError(f"a battery of {self.battery_v:.1f} V")
        return self


@runtime_checkable
class HasCamera(Protocol):
    """A link over which the robot also sends images."""

    def picture(self) -> tuple[int, int, bytes] | None:
        """Width, height and RGB565 pixels (high byte first) of a new image; None if there is none.

        It may take as long as an image takes on the line: only a robot that stands is asked.
        """


class RobotLink(Protocol):
    """An open link. Opening one sends speeds of zero first, whatever the robot was doing."""

    identity: str
    """What the robot says of itself: firmware, version."""
    motors: StepperMotors

    def exchange(self, actuators: Actuators) -> Reading:
        """Tell and ask at once. Raises ReplyError or LinkError; in either case the robot may have obeyed."""

    def close(self) -> None:
        """Let go of the link; the wheels stay as they are."""


def require_agreement(first: Reading, second: Reading, steps: int) -> None:
    """ReplyError if the counters of two readings lie further apart than the wheels can have turned."""
    moved = wrapped_difference(second.left, first.left), wrapped_difference(second.right, first.right)
    if max(map(abs, moved)) > steps:
        raise ReplyError(f"the counters moved by {moved} between two readings")


def wrapped_difference(later: int, earlier: int) -> int:
    """How far a 16-bit counter went from one reading to another, by the shorter way."""
    return ((later - earlier + 0x8000) & 0xFFFF) - 0x8000
