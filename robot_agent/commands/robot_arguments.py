"""The command line of tools that move one robot of an experiment."""

from __future__ import annotations

import argparse

from robot_agent.addresses import add_address_argument
from swarm.config.experiment import Experiment
from swarm.errors import UserError, nearest
from swarm.runtime.process import OneLineParser, add_common_arguments


def add_robot_arguments(parser: OneLineParser) -> None:
    """The experiment, the server, the robot and where it is, and the form of the result."""
    add_common_arguments(parser)
    add_address_argument(parser)
    parser.add_argument("--robot", default="", metavar="ID", help="which robot")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")


def require_robot(arguments: argparse.Namespace, experiment: Experiment) -> None:
    """UserError if the experiment has no robot of that name."""
    known = [robot.id for robot in experiment.robot]
    if arguments.robot not in known:
        cure = nearest(arguments.robot, known)
        raise UserError(f"--robot {arguments.robot!r} is not in the experiment; {cure}")
