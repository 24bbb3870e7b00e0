"""What the bridge asks of a tracking system."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from swarm.geometry import Pose


@dataclass(frozen=True, slots=True)
class TrackedPose:
    """One robot as a tracking system saw it, in the arena frame, at the run's time of capture."""

    robot: str
    pose: Pose
    captured_t_ns: int


class Backend(Protocol):
    """A tracking system. A new one is a class with this method; `tests/contracts` examines it."""

    def poses(self, t_ns: int) -> list[TrackedPose]:
        """Everything measured since the last call, oldest first, each with its own time of capture.

        Called at every tick with the run's time; it never waits. Coordinates are already those of the
        arena frame, in metres and radians.
        """
