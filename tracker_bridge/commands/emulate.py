"""`tracker-bridge emulate`."""

from __future__ import annotations

import argparse
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path

import numpy as np

from swarm.clock import unix_clock
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.runtime.process import add_protection_arguments, session_settings
from swarm.signals import leave_on_signals
from tracker_bridge.backends.interface import Backend
from tracker_bridge.backends.replay import replay
from tracker_bridge.emulators.interface import Emulator
from tracker_bridge.emulators.motion import Circles, TruthOfRun
from tracker_bridge.emulators.natnet import NatNetEmulator
from tracker_bridge.emulators.serving import serve
from tracker_bridge.emulators.vicon import ViconEmulator
from tracker_bridge.protocols import natnet, vicon

SYSTEMS = ("vicon", "natnet")
"""A new emulator adds its name here, and a line in `_emulator`."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("system", choices=SYSTEMS, help="which tracking system to play")
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="robots and [tracker] table")
    add_set_option(parser)
    parser.add_argument("--to", default="127.0.0.1", metavar="HOST", help="vicon: who gets it (%(default)s)")
    parser.add_argument("--version", default="3.0", help="natnet: the version to speak (%(default)s)")
    parser.add_argument("--rate", type=float, default=100.0, help="frames a second (%(default)s)")
    parser.add_argument("--seconds", type=float, default=0.0, help="how long; 0 is until Ctrl-C")
    motion = parser.add_mutually_exclusive_group()
    motion.add_argument("--file", type=Path, help="a recording or a log: where the robots are")
    motion.add_argument("--connect", metavar="tls/HOST:PORT", help="a simulated run: where the robots are")
    add_protection_arguments(parser)


def run(arguments: argparse.Namespace) -> None:
    """Serve until the time is over; without a recording or a run, robots drive in circles."""
    leave_on_signals()
    experiment = Experiment.load(arguments.experiment, arguments.set)
    with ExitStack() as stack:
        emulator = stack.enter_context(closing(_emulator(arguments, experiment)))
        motion = _motion(arguments, experiment, stack)
        serve(emulator, motion, unix_clock(), 1.0 / arguments.rate, arguments.seconds)


def _emulator(arguments: argparse.Namespace, experiment: Experiment) -> Emulator:
    settings = experiment.tracker
    if arguments.system == "vicon":
        return ViconEmulator(experiment, arguments.to, settings.port or vicon.DEFAULT_PORT)
    try:
        return NatNetEmulator(experiment, settings.server or "0.0.0.0", natnet.version_of(arguments.version))
    except ValueError as error:
        raise UserError(f"--version: {error}") from error


def _motion(arguments: argparse.Namespace, experiment: Experiment, stack: ExitStack) -> Backend:
    if arguments.file:
        plain = replace(experiment.tracker, axes="x y z", unit_m=0.0, origin_m=(0.0, 0.0), turn_rad=0.0)
        return replay(replace(experiment, tracker=plain), arguments.file)
    rng = np.random.default_rng(experiment.run.seed)
    if arguments.connect:
        return stack.enter_context(TruthOfRun.of(session_settings(arguments, arguments.connect), rng))
    return Circles(experiment, rng)
