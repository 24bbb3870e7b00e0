"""`robot-agent emulate`: a robot that is not there, for drivers and for people who learn to use them."""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import fields
from pathlib import Path

import numpy as np

from robot_agent.emulator.emulation import LINKS, MODELS, Emulation, RobotToEmulate, default_address
from robot_agent.emulator.faults import Faults
from swarm.clock import unix_clock
from swarm.geometry import Compartment, Grid, Pose
from swarm.runtime.process import OneLineParser, leave_on_signals

PLACE = Compartment(0.0, 0.0, Grid(10, 10), 0.12)
"""The robot stands in the middle of a compartment of the paper's size."""


def emulate(arguments: argparse.Namespace) -> None:
    """Serve one robot until the process is told to leave; say where it is, and then what it does."""
    leave_on_signals()
    pose = Pose(0.5 * (PLACE.west_m + PLACE.east_m), 0.5 * (PLACE.south_m + PLACE.north_m), 0.0)
    faults = Faults.parse(arguments.fault)
    wanted = RobotToEmulate(arguments.link, PLACE, pose, arguments.model, faults=faults)
    address = arguments.at or default_address(arguments.link, Path.cwd(), "emulated")
    rng = np.random.default_rng(arguments.seed)
    with Emulation(wanted, address, time.monotonic_ns, rng) as emulation:
        _say({"link": arguments.link, "address": emulation.address}, as_json=arguments.json)
        for _ in unix_clock().ticks(1.0):
            with emulation.lock:
                truth = emulation.robot.truth(time.monotonic_ns())
            left, right = emulation.robot.commanded
            place = {"x_m": round(truth.x_m, 4), "y_m": round(truth.y_m, 4)}
            turned = {"theta_rad": round(truth.theta_rad, 4), "left": left, "right": right}
            _say({**place, **turned}, as_json=arguments.json)


def _say(values: dict[str, object], *, as_json: bool) -> None:
    text = json.dumps(values) if as_json else "  ".join(f"{name} {value}" for name, value in values.items())
    print(text, flush=True)


def emulate_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent emulate",
        description="Emulates a robot, byte for byte, at one end of a link.",
        epilog="faults: " + ", ".join(field.name for field in fields(Faults)),
    )
    parser.add_argument("link", choices=LINKS, help="how the robot is reached")
    parser.add_argument("--at", default="", metavar="ADDRESS", help="where (a file, unix:FILE or HOST:PORT)")
    parser.add_argument("--model", choices=MODELS, default="epuck2", help="which robot (%(default)s)")
    parser.add_argument(
        "--fault", action="append", default=[], metavar="NAME=VALUE", help="switch a fault on"
    )
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the faults (%(default)s)")
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    return parser
