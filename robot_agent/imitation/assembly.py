"""Gives a robot that is to watch others its eyes: camera, colour table, detector.

Everything here is imported only by robots that watch, so that the others stay small.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robot_agent.drivers.interfaces import Driver, DriverParts
from robot_agent.drivers.sim.camera import BUILT_IN_MODEL, calibration_frames_of
from robot_agent.imitation.visit import BeginVisit, Eyes, Visit
from robot_agent.navigation.pose_estimator import PoseAt
from robot_agent.policies.learner import LearningPolicy
from robot_agent.reports import Reporter
from robot_agent.vision.camera_model import CameraModel, load_camera_model
from robot_agent.vision.colour_calibration import learn_colour_table
from robot_agent.vision.colour_table import ColourTable, load_colour_table
from robot_agent.vision.detector import MEASUREMENTS, Detector
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb


def visits_of(
    parts: DriverParts, driver: Driver, policy: LearningPolicy, pose_at: PoseAt, reporter: Reporter
) -> BeginVisit:
    """What makes a visit of an order, for a learner that watches the robot named in its settings."""
    experiment = parts.experiment
    settings, demonstrator = experiment.visits, experiment.robot_named(parts.robot.watches)
    profile = MEASUREMENTS[settings.profile]
    model = _model(experiment).scaled(profile.width, profile.height)
    table = _colours(experiment, model, demonstrator.skirt, parts.generator("calibration"))
    watched = experiment.compartment(demonstrator)
    eyes = Eyes(
        driver.camera(model),
        Detector(settings.profile, model, table),
        pose_at,
        settings,
        experiment.arena.cell_m,
        watched.centre(watched.grid.start),
        parts.generator("window"),
        lambda path, visit: policy.remember(path, "camera", visit),
    )

    def begin(order: pb.Order) -> Visit:
        return Visit(order, eyes, parts.geometry, reporter)

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
