"""`tracker-bridge watch`."""

from __future__ import annotations

import argparse
import sys
from itertools import islice
from pathlib import Path

from swarm.clock import unix_clock
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.signals import leave_on_signals
from tracker_bridge.arena_view import in_characters, write_picture
from tracker_bridge.listening import listening
from tracker_bridge.survey import table

CLEAR = "\x1b[H\x1b[2J"
"""Terminals: the cursor to the corner, and nothing shown."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="whose [tracker] table")
    add_set_option(parser)
    parser.add_argument("--every", type=float, default=1.0, help="seconds between tables (%(default)s)")
    parser.add_argument("--times", type=int, default=0, help="tables to show; 0 is until Ctrl-C")
    parser.add_argument("--picture", type=Path, metavar="FILE.png", help="draw the tracks here")


def run(arguments: argparse.Namespace) -> None:
    """A new table and arena in place of the last ones, or below them where there is no terminal."""
    leave_on_signals()
    experiment = Experiment.load(arguments.experiment, arguments.set)
    with listening(experiment, unix_clock()) as listener:
        for report, tracks in islice(listener.watched(arguments.every), arguments.times or None):
            text = f"{table(report)}\n{in_characters(tracks, experiment.arena)}"
            print((CLEAR if sys.stdout.isatty() else "") + text, flush=True)
            if arguments.picture:
                write_picture(arguments.picture, tracks, experiment.arena)
