"""`tracker-bridge calibrate`."""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

from swarm.clock import unix_clock
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from tracker_bridge.calibration import KnownPoint, calibrate
from tracker_bridge.listening import seen_at


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="whose [tracker] table")
    add_set_option(parser)
    parser.add_argument("--points", type=Path, metavar="FILE.csv", help="lines of seen x,y,z and arena x,y")
    parser.add_argument("--body", default="", help="the body that is put at the places; any if not given")
    parser.add_argument("--at", action="append", default=[], metavar="X,Y", help="a known place, in metres")
    parser.add_argument("--seconds", type=float, default=2.0, help="to look at each place (%(default)s)")


def run(arguments: argparse.Namespace) -> None:
    """Print the lines for the [tracker] table, and how well they fit."""
    points = _read(arguments.points) if arguments.points else _asked(arguments)
    calibration = calibrate(points)
    print(calibration.toml(), end="")
    for point, residual_m in zip(points, calibration.residuals_m, strict=True):
        print(f"# ({point.place_m[0]:g}, {point.place_m[1]:g}) m: {1000 * residual_m:.1f} mm off")


def _asked(arguments: argparse.Namespace) -> list[KnownPoint]:
    """Ask the person to put the body at each place, and look where the system sees it."""
    experiment, points = Experiment.load(arguments.experiment, arguments.set), []
    for text in arguments.at:
        place_m = _place(text)
        input(f"Put {arguments.body or 'the body'} at ({place_m[0]:g}, {place_m[1]:g}) m, then press Enter: ")
        points.append(
            KnownPoint(seen_at(experiment, arguments.body, arguments.seconds, unix_clock()), place_m)
        )
    return points


def _place(text: str) -> tuple[float, float]:
    try:
        x_m, y_m = map(float, text.split(","))
    except ValueError as error:
        raise UserError(f"--at {text}: give a place as X,Y in metres, such as 0.21,0.21") from error
    return x_m, y_m


def _read(file: Path) -> list[KnownPoint]:
    try:
        rows = [[float(cell) for cell in row] for row in csv.reader(file.read_text().splitlines()) if row]
        return [KnownPoint((x, y, z), (x_m, y_m)) for x, y, z, x_m, y_m in rows]
    except OSError as error:
        raise UserError(f"{file}: {error.strerror}") from error
    except ValueError as error:
        raise UserError(f"{file}: every line has five numbers, seen x,y,z and arena x,y: {error}") from error
