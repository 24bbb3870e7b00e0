"""`robot-agent calibrate wheels`: wheel diameter and wheel base of one robot, under the running tracker."""

from __future__ import annotations

import argparse
import json
from contextlib import suppress
from dataclasses import replace

from robot_agent.addresses import add_address_argument, addresses
from robot_agent.assembly import Assembly, Place
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.registry import make_driver
from robot_agent.navigation.wheel_calibration import Leg, WheelCalibration, calibration_of, drive_squares
from swarm.config.experiment import Experiment
from swarm.errors import UserError, nearest
from swarm.geometry import Pose
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.node import Node
from swarm.runtime.process import OneLineParser, add_common_arguments, joined, load_experiment
from swarm.signals import leave_on_signals


class SquaresDrivenError(Exception):
    """The squares are driven: what ends the steps of a node."""


def calibrate_wheels(arguments: argparse.Namespace) -> None:
    """Drive the squares, and say what belongs into the robot's table."""
    experiment = load_experiment(arguments)
    known = [robot.id for robot in experiment.robot]
    if arguments.robot not in known:
        cure = nearest(arguments.robot, known)
        raise UserError(f"--robot {arguments.robot!r} is not in the experiment; {cure}")
    leave_on_signals()
    identity = RunIdentity.of(experiment, arguments.trial)
    period_s = experiment.simulation.tick_s
    with joined(arguments, "calibration", [arguments.robot], period_s, identity) as node:
        place = Place(addresses(arguments.address), arguments.speed, arguments.lockstep)
        assembly = Assembly(experiment, node, arguments.trial, place)
        calibration = calibration_of(_legs(experiment, node, assembly, arguments.robot))
    print(json.dumps(vars(calibration)) if arguments.json else _text(calibration))


def _legs(experiment: Experiment, node: Node, assembly: Assembly, robot: str) -> list[Leg]:
    nominal = EpuckGeometry()
    body = make_driver(replace(assembly.driver_parts(robot), geometry=nominal)).body
    fixes = node.subscribe(topics.POSE, robot)

    def poses() -> list[Pose]:
        return [Pose(fix.message.x_m, fix.message.y_m, fix.message.theta_rad) for fix in fixes.take()]

    squares = drive_squares(body, poses, nominal, experiment.simulation.tick_s)
    next(squares)
    legs: list[Leg] = []

    def step(t_ns: int) -> None:
        try:
            squares.send(t_ns)
        except StopIteration as driven:
            legs.extend(driven.value)
            raise SquaresDrivenError from driven

    try:
        with suppress(SquaresDrivenError):
            node.run(step)
    finally:
        body.close()
    return legs


def _text(calibration: WheelCalibration) -> str:
    """Lines for the experiment file."""
    found = calibration
    return (
        f"wheel_diameter_m = {found.wheel_diameter_m:.5f}  # +- {found.wheel_diameter_error_m:.5f}\n"
        f"wheel_base_m = {found.wheel_base_m:.5f}  # +- {found.wheel_base_error_m:.5f}"
    )


def calibrate_wheels_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent calibrate wheels",
        description="Drives a robot in two squares of 25 cm, one each way, under the running tracker, and "
        "says its wheels' diameter and base. Give it a square metre.",
    )
    add_common_arguments(parser)
    add_address_argument(parser)
    parser.add_argument("--robot", default="", metavar="ID", help="which robot")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")
    return parser
