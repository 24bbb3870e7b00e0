"""Gives a robot that is to watch others its eyes: camera, colour table, seer.

Everything here is imported only by robots that watch, so that the others stay small.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from robot_agent.agent import BeginVisit
from robot_agent.brain import Publish
from robot_agent.drivers.camera_model import CameraModel, load_camera_model
from robot_agent.drivers.epuck import EpuckGeometry
from robot_agent.drivers.sim_camera import BUILT_IN_MODEL, SimulatedRobotCamera, calibration_frames_of
from robot_agent.drivers.sim_robot import SimulatedRobot
from robot_agent.imitation.calibration import learn_colour_table
from robot_agent.imitation.colour import ColourTable, load_colour_table
from robot_agent.imitation.seeing import PROFILES, Seer
from robot_agent.learner import Learner
from robot_agent.visit import Eyes, Visit
from swarm.experiment import Experiment, RobotSettings
from swarm.link import Link
from swarm.messages import swarm_pb2 as pb


def visits_of(
    experiment: Experiment,
    robot: RobotSettings,
    learner: Learner,
    body: SimulatedRobot,
    geometry: EpuckGeometry,
    link: Link,
    publish: Publish,
    generator: Callable[[str], np.random.Generator],
) -> BeginVisit:
    """What makes a visit of an order, for a learner that watches the robot named in its settings."""
    settings, demonstrator = experiment.visits, experiment.robot_named(robot.watches)
    profile = PROFILES[settings.profile.value]
    model = _model(experiment).scaled(profile.width, profile.height)
    camera = SimulatedRobotCamera(
        model, experiment.camera.conditions, body.body, link, robot.id, generator("camera")
    )
    table = _colours(experiment, model, demonstrator.skirt, generator("calibration"))
    eyes = Eyes(
        camera,
        Seer(settings.profile.value, model, table),
        settings,
        experiment.arena.cell_m,
        experiment.compartment(demonstrator).centre(experiment.compartment(demonstrator).grid.start),
        generator("window"),
        lambda path, visit: learner.remember(path, "camera", visit),
    )

    def begin(order: pb.Order) -> Visit:
        return Visit(order, eyes, geometry, publish)

    return begin


def _model(experiment: Experiment) -> CameraModel:
    file = experiment.camera.calibration
    return load_camera_model(Path(file)) if file else BUILT_IN_MODEL


def _colours(experiment: Experiment, model: CameraModel, skirt: str, rng: np.random.Generator) -> ColourTable:
    """The table in the settings, or one learnt in good light before the run, as in a laboratory."""
    file = experiment.camera.colours
    if file:
        return load_colour_table(Path(file))
    return learn_colour_table(calibration_frames_of(model, skirt, rng), model, skirt)
