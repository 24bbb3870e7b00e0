"""The `tracker-bridge` command: the process beside the tracking system, and what helps to set it up."""

from __future__ import annotations

import argparse
import sys
from importlib import import_module

from swarm.checkup.finding import require_good
from swarm.config.arguments import place
from swarm.errors import guarded
from swarm.extras import naming_extras
from swarm.messages import topics
from swarm.runtime.clock_report import report_clock
from swarm.runtime.identity import RunIdentity
from swarm.runtime.process import (
    OneLineParser,
    add_common_arguments,
    joined,
    leave_with_parent,
    load_experiment,
)
from swarm.signals import leave_on_signals
from tracker_bridge.backends.interface import Setup
from tracker_bridge.backends.registry import system_named
from tracker_bridge.bridge import Bridge
from tracker_bridge.checks import checks
from tracker_bridge.commands import VERBS
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings


def main() -> None:
    """Entry point of `tracker-bridge`."""
    sys.exit(guarded(lambda: call(sys.argv[1:])))


@naming_extras()
def call(words: list[str]) -> None:
    """Do what a verb says, or, without one, pass poses on."""
    verb = next((verb for verb in (" ".join(words[:2]), *words[:1]) if verb in VERBS), None)
    if verb is None:
        run(_parser().parse_args(words))
        return
    command = import_module(f"tracker_bridge.commands.{verb.replace(' ', '_')}")
    about = {"prog": f"tracker-bridge {verb}", "description": VERBS[verb]}
    parser = OneLineParser(**about, conflict_handler="resolve")  # a verb's --version may be a protocol's
    command.add_arguments(parser)
    command.run(parser.parse_args(words[len(verb.split()) :]))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and pass poses on until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    require_good(arguments.experiment, checks(experiment))
    system = system_named(experiment.tracker.backend)
    leave_on_signals()
    if arguments.supervised:
        leave_with_parent()
    period_s = system.poll_s or experiment.simulation.tick_s
    identity = RunIdentity.of(experiment, arguments.trial)
    with (
        joined(arguments, "tracker", ["bridge"], period_s, identity) as node,
        system.open(Setup(experiment, node, arguments.trial)) as backend,
    ):
        arena = experiment.arena
        plausibility = Plausibility(PlausibilitySettings(arena.width_m, arena.height_m))
        robots = [robot.id for robot in experiment.robot]
        bridge = Bridge(backend, plausibility, node, robots, experiment.pose_lateness_s, arguments.speed)
        if not arguments.supervised:
            report_clock(node, topics.TRACKER_EVENT)
        node.run(bridge.step)


def _parser() -> OneLineParser:
    verbs = "\n".join(f"  tracker-bridge {verb:<17} {meaning}" for verb, meaning in VERBS.items())
    parser = OneLineParser(
        prog="tracker-bridge",
        description="The process beside the tracking system: it tells each robot where that robot is.\n"
        "The experiment's [tracker] table says which system it is.\n\nTo set it up:\n" + verbs,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_common_arguments(parser)
    parser.add_argument(
        "--state", type=place, metavar="DIR", help="where events are kept that a server may have missed"
    )
    return parser
