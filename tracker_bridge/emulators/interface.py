"""What every emulator does, and how it sees robots as its system would."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from swarm.config.experiment import Experiment
from tracker_bridge.backends.bodies import arena_frame
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.protocols.cursor import Quaternion, Vector

HAT_HEIGHT_M = 0.08
"""Markers on top of an e-puck that is 5 cm tall."""


class Emulator(Protocol):
    """A tracking system that is told where robots are and says so to whoever listens."""

    def show(self, poses: Iterable[TrackedPose], t_ns: int) -> None:
        """One frame, taken at this time."""

    def close(self) -> None:
        """Stop serving."""


@dataclass(frozen=True, slots=True)
class SeenRobot:
    """A robot in the system's own axes and unit, under its name there."""

    body: str
    position: Vector
    rotation: Quaternion


class View:
    """Sees robots through the experiment's [tracker] table, the other way round than the bridge."""

    def __init__(self, experiment: Experiment, unit_m: float) -> None:
        self._frame = arena_frame(experiment, unit_m)
        self._robots = {robot.id: robot for robot in experiment.robot}

    def seen(self, poses: Iterable[TrackedPose]) -> list[SeenRobot]:
        return [self._robot(tracked) for tracked in poses]

    def _robot(self, tracked: TrackedPose) -> SeenRobot:
        robot = self._robots.get(tracked.robot)
        turn_rad = robot.body_turn_rad if robot else 0.0
        name = (robot.body if robot else "") or tracked.robot
        height_m = HAT_HEIGHT_M if tracked.height_m is None else tracked.height_m
        return SeenRobot(name, *self._frame.seen(tracked.pose, height_m, turn_rad))
