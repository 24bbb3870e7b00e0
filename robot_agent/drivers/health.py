"""How a real robot and its link do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable


@dataclass(frozen=True, slots=True)
class BodyHealth:
    """What a robot says beside its steps, and how well its link works."""

    battery_v: float
    """0 if the robot does not say."""
    proximity: tuple[int, ...]
    """Infra-red echoes ps0 to ps7, 0..4095: 120 is a wall at 5 cm, 4095 one that is touched."""
    reading_age_s: float
    """Since the last good answer."""
    failed_exchanges: int
    refused_readings: int
    """Step counters that the wheels cannot have made."""
    refused_commands: int
    """Commands that came after their deadline."""


@runtime_checkable
class TellsHealth(Protocol):
    """A body that knows how it does; simulated ones do not."""

    @property
    def health(self) -> BodyHealth:
        """The newest there is."""
