"""What an emulated robot's camera shows: rendered, and sent over its link like a real picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np

from robot_agent.drivers.sim.camera import BUILT_IN_MODEL
from robot_agent.drivers.sim.rendering.camera import SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Rectangle, Scene, SceneRobot
from robot_agent.emulator.esp32 import IMAGE_HEIGHT, IMAGE_WIDTH
from robot_agent.emulator.robot import Look
from robot_agent.vision.camera_model import load_camera_model
from swarm.config.experiment import Experiment, RobotSettings
from swarm.geometry import Pose


def rendered_look(
    experiment: Experiment,
    robot: RobotSettings,
    truth_at: Callable[[int], Pose],
    truths: Mapping[str, Pose],
    rng: np.random.Generator,
) -> Look:
    """The compartment of the robot that this one watches, and in it whoever `truths` says at that moment.

    Motion blurs nothing here: the truths of a tick do not tell speeds. The picture has the calibration's
    field of view, whatever its size.
    """
    file = experiment.camera.calibration
    model = load_camera_model(Path(file)) if file else BUILT_IN_MODEL
    walls = experiment.compartment(experiment.robot_named(robot.watches))
    room = Rectangle(walls.west_m, walls.south_m, walls.east_m, walls.north_m)

    @cache
    def camera(width: int, height: int) -> SimulatedCamera:
        return SimulatedCamera(model.scaled(width, height), conditions(experiment.camera.conditions), rng)

    def look(width: int, height: int, t_ns: int) -> bytes:
        others = [other for other in experiment.robot if other.id != robot.id and other.id in truths]
        bodies = tuple(SceneRobot(truths[other.id], other.skirt) for other in others)
        return camera(width, height).render(t_ns, truth_at(t_ns), Scene((room,), bodies)).data

    # Compiled or loaded now: the first picture must not hold the robot up.
    camera(IMAGE_WIDTH, IMAGE_HEIGHT).render(0, Pose(room.west_m, room.south_m, 0.0), Scene((room,)))
    return look
