"""`robot-agent calibrate wheels`: wheel diameter and wheel base of one robot, under the running tracker."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace

from robot_agent.addresses import addresses
from robot_agent.assembly import Assembly, Place
from robot_agent.commands.node_steps import run_steps
from robot_agent.commands.robot_arguments import add_robot_arguments, require_robot
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.registry import make_driver
from robot_agent.navigation.wheel_calibration import Leg, WheelCalibration, calibration_of, drive_squares
from swarm.config.experiment import Experiment
from swarm.geometry import Pose
from swarm.messages import topics
from swarm.runtime.identity import RunIdentity
from swarm.runtime.node import Node
from swarm.runtime.process import OneLineParser, joined, load_experiment
from swarm.signals import leave_on_signals


def calibrate_wheels(arguments: argparse.Namespace) -> None:
    """Drive the squares, and say what belongs into the robot's table."""
    experiment = load_experiment(arguments)
    require_robot(arguments, experiment)
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

    try:
        return run_steps(node, drive_squares(body, poses, nominal, experiment.simulation.tick_s))
    finally:
        body.close()


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
    add_robot_arguments(parser)
    return parser
