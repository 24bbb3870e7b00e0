"""What the bridge asks of a tracking system."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

from swarm.config.experiment import Experiment
from swarm.geometry import Pose
from swarm.runtime.node import Node

POLL_S = 0.002
"""How often a real tracking system is asked: a pose then waits 1 ms on the average."""


class TrackedPose(NamedTuple):
    """One robot as a tracking system saw it, in the arena frame, at the run's time of capture.

    What a system does not say stays 0, and None for what may really be 0.
    """

    robot: str
    pose: Pose
    captured_t_ns: int
    received_t_ns: int = 0
    """The run's time at which it reached this machine."""
    source_t_ns: int = 0
    """The tracking system's own time of capture, by its own clock."""
    residual_m: float = 0.0
    """How far the markers were from where they should be."""
    quality: float = 0.0
    """The share of the robot's markers that were seen."""
    height_m: float | None = None
    tilt_rad: float | None = None
    """How far the robot leans."""


class Backend(Protocol):
    """A tracking system. A new one is a class with this method; `tests/contracts` examines it."""

    def poses(self, t_ns: int) -> list[TrackedPose]:
        """Everything measured since the last call, oldest first, each with its own time of capture.

        Called at every tick with the run's time; it never waits. Coordinates are already those of the
        arena frame, in metres and radians.
        """


@runtime_checkable
class Telling(Protocol):
    """A backend that also has events to tell, such as two robots that swapped."""

    def told(self) -> list[tuple[str, str]]:
        """Each event since the last call, by its name and its text."""


@dataclass(frozen=True)
class Setup:
    """What a backend is made from."""

    experiment: Experiment
    node: Node | None
    """None where there is no run, as in `tracker-bridge check`."""
    trial: int = 0


@dataclass(frozen=True)
class TrackingSystem:
    """A line of the registry: how a backend is opened, and for as long as the block runs."""

    open: Callable[[Setup], AbstractContextManager[Backend]]
    poll_s: float | None = POLL_S
    """How often it is asked; None for at every tick of the experiment."""
