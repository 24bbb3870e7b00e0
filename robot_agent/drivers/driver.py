"""What drives a robot: its wheels and, if it has one, its camera."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robot_agent.drivers.body import Body
from robot_agent.drivers.camera import Camera
from robot_agent.drivers.camera_model import CameraModel
from robot_agent.drivers.epuck import EpuckGeometry
from swarm.experiment import Experiment, RobotSettings
from swarm.link import Link


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
    link: Link
    generator: Callable[[str], np.random.Generator]
    address: str = ""
    """Where a real robot is: the settings' address, or that of its emulation."""
    speed: float = 1.0
    """How many times as fast as life the run's time passes."""
    lockstep: bool = False
    """Whether time passes in steps: nothing that is outside this program can join then."""
