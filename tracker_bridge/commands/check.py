"""`tracker-bridge check`."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from swarm.clock import unix_clock
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.errors import RunFailedError
from tracker_bridge.listening import listening
from tracker_bridge.survey import table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="whose [tracker] table")
    add_set_option(parser)
    parser.add_argument("--seconds", type=float, default=5.0, help="how long to listen (%(default)s)")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(arguments: argparse.Namespace) -> None:
    """Print what arrived; exit code 1 if a robot is missing or a setting looks wrong."""
    with listening(Experiment.load(arguments.experiment, arguments.set), unix_clock()) as listener:
        report = listener.survey(arguments.seconds).report(arguments.seconds, listener.arrivals)
    print(json.dumps(asdict(report)) if arguments.json else table(report))
    if report.missing or report.mistakes:
        missing = f"not seen: {', '.join(report.missing)}" if report.missing else ""
        raise RunFailedError("; ".join(filter(None, [missing, *report.mistakes])))
