"""The `tracker-bridge` command: the process beside the tracking system."""

from __future__ import annotations

import argparse
import sys

from swarm.errors import guarded
from swarm.runtime.identity import RunIdentity
from swarm.runtime.process import (
    OneLineParser,
    add_common_arguments,
    joined,
    leave_on_signals,
    load_experiment,
)
from tracker_bridge.backends.registry import backend_named
from tracker_bridge.bridge import Bridge
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings


def main() -> None:
    """Entry point of `tracker-bridge`."""
    sys.exit(guarded(lambda: run(_parser().parse_args())))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and pass poses on until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    make_backend = backend_named(experiment.tracker.backend)
    leave_on_signals()
    identity = RunIdentity.of(experiment, arguments.trial)
    with joined(arguments, "tracker", ["bridge"], experiment.simulation.tick_s, identity) as node:
        backend = make_backend(experiment, node, arguments.trial)
        arena = experiment.arena
        plausibility = Plausibility(PlausibilitySettings(arena.width_m, arena.height_m))
        bridge = Bridge(backend, plausibility, node, [robot.id for robot in experiment.robot])
        node.run(bridge.step)


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="tracker-bridge",
        description="The process beside the tracking system: it tells each robot where that robot is, and no "
        "other. The experiment's [tracker] table says which tracking system it is.",
    )
    add_common_arguments(parser)
    return parser
