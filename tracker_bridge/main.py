"""The `tracker-bridge` command: the process beside the tracking system."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial

from swarm import keys
from swarm.errors import UserError, nearest
from swarm.experiment import Experiment
from swarm.guard import guarded
from swarm.learning.random import spawned_generator
from swarm.link import Link
from swarm.process import OneLineParser, add_common_arguments, joined, leave_on_signals, load_experiment
from tracker_bridge.backends.backend import Backend
from tracker_bridge.backends.sim import SimulatedTracker
from tracker_bridge.bridge import Bridge
from tracker_bridge.gate import Gate, GateSettings


def main() -> None:
    """Entry point of `tracker-bridge`."""
    sys.exit(guarded(lambda: run(_parser().parse_args())))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and pass poses on until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    make_backend = _backend_named(experiment.tracker.backend)
    leave_on_signals()
    with joined(arguments, "tracker", ["bridge"], experiment.simulation.tick_s) as link:
        backend = make_backend(experiment, link, arguments.trial)
        arena = experiment.arena
        gate = Gate(GateSettings(arena.width_m, arena.height_m))
        bridge = Bridge(backend, gate, link, [robot.id for robot in experiment.robot])
        link.run(bridge.step)


MakeBackend = Callable[[Experiment, Link, int], Backend]


def _simulated(experiment: Experiment, link: Link, trial: int) -> Backend:
    truths = link.subscribe(keys.TRUTH)
    generator = partial(spawned_generator, experiment.run.seed, "", trial, component="tracker")
    return SimulatedTracker(experiment.tracker, truths.take, lambda robot: generator(robot=robot))


BACKENDS: dict[str, MakeBackend] = {"sim": _simulated}
"""[tracker] backend: a new tracking system adds one line."""


def _backend_named(name: str) -> MakeBackend:
    if name not in BACKENDS:
        raise UserError(f"[tracker] backend is {name!r}; {nearest(name, BACKENDS)}")
    return BACKENDS[name]


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="tracker-bridge",
        description="The process beside the tracking system: it tells each robot where that robot is, and no "
        "other. The experiment's [tracker] table says which tracking system it is.",
    )
    add_common_arguments(parser)
    return parser
