"""`tracker-bridge watch`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from swarm.clock import unix_clock
from swarm.config.experiment import Experiment
from swarm.runtime.process import leave_on_signals
from tracker_bridge.listening import listening
from tracker_bridge.survey import table

CLEAR = "\x1b[H\x1b[2J"
"""Terminals: the cursor to the corner, and nothing shown."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="whose [tracker] table")
    parser.add_argument("--every", type=float, default=1.0, help="seconds between tables (%(default)s)")
    parser.add_argument("--times", type=int, default=0, help="tables to show; 0 is until Ctrl-C")


def run(arguments: argparse.Namespace) -> None:
    """A new table in place of the last one, or below it where there is no terminal."""
    leave_on_signals()
    shown = 0
    with listening(Experiment.load(arguments.experiment), unix_clock()) as listener:
        while arguments.times == 0 or shown < arguments.times:
            text = table(listener.survey(arguments.every))
            print((CLEAR if sys.stdout.isatty() else "") + text, flush=True)
            shown += 1
