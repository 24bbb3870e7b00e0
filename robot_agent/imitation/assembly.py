"""Gives a robot that is to watch others its eyes: camera, calibration, detector.

Everything here is imported only by robots that watch, so that the others stay small.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from robot_agent.drivers.interfaces import Camera, Driver, DriverParts
from robot_agent.drivers.sim.camera import BUILT_IN_MODEL, calibration_frames_of
from robot_agent.imitation.visit import BeginVisit, Eyes, Visit
from robot_agent.navigation.pose_estimator import PoseAt
from robot_agent.policies.learner import LearningPolicy
from robot_agent.reports import Reporter
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CameraModel, load_calibration
from robot_agent.vision.colour_table import load_colour_table
from robot_agent.vision.demonstrator import Demonstrator, Skirt
from robot_agent.vision.detector import Detector, at_profile
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb


def visits_of(
    parts: DriverParts, driver: Driver, policy: LearningPolicy, pose_at: PoseAt, reporter: Reporter
) -> BeginVisit:
    """What makes a visit of an order, for a learner that watches the robot named in its settings."""
    experiment = parts.experiment
    demonstrator = experiment.robot_named(parts.robot.watches)
    camera, detector = sight_of(parts, driver)
    watched = experiment.compartment(demonstrator)
    eyes = Eyes(
        camera,
        detector,
        pose_at,
        experiment.visits,
        experiment.arena.cell_m,
        watched.centre(watched.grid.start),
        parts.generator("window"),
        lambda path, visit: policy.remember(path, "camera", visit),
    )

    def begin(order: pb.Order) -> Visit:
        return Visit(order, eyes, parts.geometry, reporter)

    return begin


def sight_of(parts: DriverParts, driver: Driver) -> tuple[Camera, Detector]:
    """The robot's camera, and a detector trained on the skirt of the robot that it watches."""
    skirt = parts.experiment.robot_named(parts.robot.watches).skirt
    detector = _detector(parts.experiment, skirt, parts.generator("calibration"))
    return driver.camera(detector.model), detector


def _detector(experiment: Experiment, skirt: str, rng: np.random.Generator) -> Detector:
    file = experiment.camera.calibration
    calibration = load_calibration(Path(file)) if file else None
    profile = experiment.visits.profile
    model = at_profile(profile, calibration.model() if calibration else BUILT_IN_MODEL)
    known = calibration.demonstrator() if calibration else None
    size = calibration.skirt if calibration and calibration.skirt else Skirt(skirt)
    return Detector(profile, model, known or _learnt(experiment, model, size, rng))


def _learnt(
    experiment: Experiment, model: CameraModel, skirt: Skirt, rng: np.random.Generator
) -> Demonstrator:
    """From a colour table in the settings, or in good light before the run, as in a laboratory."""
    file = experiment.camera.colours
    if file:
        return load_colour_table(Path(file), model.gamma)
    return learn_demonstrator(calibration_frames_of(model, skirt.name, rng), model, skirt).demonstrator
