"""The `tracker-bridge` command: the process beside the tracking system."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module

from swarm.errors import guarded
from swarm.runtime.process import (
    OneLineParser,
    add_common_arguments,
    joined,
    leave_on_signals,
    load_experiment,
)
from tracker_bridge.backends.registry import backend_named
from tracker_bridge.bridge import Bridge
from tracker_bridge.commands import VERBS
from tracker_bridge.plausibility import Gate, GateSettings


def main() -> None:
    """Entry point of `tracker-bridge`."""
    sys.exit(guarded(lambda: call(sys.argv[1:])))


def call(words: list[str]) -> None:
    """Do what a verb says, or, without one, pass poses on."""
    if not words or words[0] not in VERBS:
        run(_parser().parse_args(words))
        return
    verb = import_module(f"tracker_bridge.commands.{words[0]}")
    parser = OneLineParser(prog=f"tracker-bridge {words[0]}", description=VERBS[words[0]])
    verb.add_arguments(parser)
    verb.run(parser.parse_args(words[1:]))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and pass poses on until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    make_backend = backend_named(experiment.tracker.backend)
    leave_on_signals()
    with joined(arguments, "tracker", ["bridge"], experiment.simulation.tick_s) as link:
        backend = make_backend(experiment, link, arguments.trial)
        arena = experiment.arena
        gate = Gate(GateSettings(arena.width_m, arena.height_m))
        bridge = Bridge(backend, gate, link, [robot.id for robot in experiment.robot])
        link.run(bridge.step)


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="tracker-bridge",
        description="The process beside the tracking system: it tells each robot where that robot is, and no "
        "other. The experiment's [tracker] table says which tracking system it is.",
    )
    add_common_arguments(parser)
    return parser
