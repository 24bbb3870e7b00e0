"""What drives a robot: its body and, if it has one, its camera."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds, WheelSteps
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import Frame
from swarm.config.experiment import Experiment, RobotSettings
from swarm.runtime.node import Node


class Driver(Protocol):
    """One robot's hardware. A driver without a camera raises UserError when it is asked for one."""

    @property
    def body(self) -> Body:
        """The wheels."""

    def camera(self, model: CameraModel) -> Camera:
        """The camera, at the model's resolution."""


@dataclass(frozen=True)
class DriverParts:
    """What a driver may need of the run; `generator` gives a random generator for a named component."""

    experiment: Experiment
    robot: RobotSettings
    geometry: EpuckGeometry
    node: Node
    generator: Callable[[str], np.random.Generator]
    address: str = ""
    """Where a real robot is: the settings' address, or that of its emulation."""
    speed: float = 1.0
    """How many times as fast as life the run's time passes."""
    lockstep: bool = False
    """Whether time passes in steps: nothing that is outside this program can join then."""


@runtime_checkable
class Body(Protocol):
    """A robot's wheels. A new driver is one class with these methods; `tests/contracts` examines it.

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


class Camera(Protocol):
    """A robot's eye."""

    def capture(self, t_ns: int) -> Frame | None:
        """The frame of this moment; None when the camera gives none (it is stalled or unplugged)."""
        ...
