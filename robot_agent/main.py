"""The `robot-agent` command: one process on a robot's board, or one that hosts simulated robots."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from importlib import import_module

from robot_agent.addresses import add_address_argument, addresses
from robot_agent.agent import Agent
from robot_agent.assembly import Assembly, Place
from robot_agent.checkpoint import Checkpoint, OtherRun
from robot_agent.checks import robot_checks
from swarm.checkup.finding import require_good
from swarm.checkup.machine import writable
from swarm.config.arguments import place
from swarm.config.experiment import Experiment, RobotSettings
from swarm.errors import UserError, guarded, nearest
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
from swarm.runtime.receipts import write_receipts
from swarm.signals import leave_on_signals


def main() -> None:
    """Entry point of `robot-agent`."""
    sys.exit(guarded(lambda: _called(sys.argv[1:])))


TOOLS = {
    ("calibrate", "wheels"): "robot_agent.commands.calibrate_wheels:calibrate_wheels",
    ("calibrate", "skirt"): "robot_agent.commands.calibrate_skirt:calibrate_skirt",
    ("calibrate", "camera"): "robot_agent.commands.calibrate_camera:calibrate_camera",
    ("calibrate",): "robot_agent.commands.calibrate_skirt:calibrate_skirt",
    ("check",): "robot_agent.commands.check:check",
    ("collect-copies",): "robot_agent.commands.collect_copies:collect",
    ("emulate",): "robot_agent.emulator.command:emulate",
    ("emulate-robots",): "robot_agent.emulator.in_run:emulate_robots",
    ("imitate",): "robot_agent.commands.imitate:imitate",
}
"""The first words of the command line, and MODULE:FUNCTION of the tool, whose parser is FUNCTION_parser."""


@naming_extras()
def _called(words: list[str]) -> None:
    """A tool if the first words name one, and else a robot; only what is called is loaded."""
    for name, tool_place in TOOLS.items():
        if tuple(words[: len(name)]) == name:
            module, _, function = tool_place.partition(":")
            tool = import_module(module)
            arguments = getattr(tool, f"{function}_parser")().parse_args(words[len(name) :])
            getattr(tool, function)(arguments)
            return
    run(_parser().parse_args(words))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and step the robots until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    identity = RunIdentity.of(experiment, arguments.trial)
    if arguments.calibration:
        experiment = experiment.seen_by(arguments.calibration)
    names = _names(arguments.robot, experiment)
    _check(arguments, experiment, names)
    leave_on_signals()
    if arguments.supervised:
        leave_with_parent()
    with joined(arguments, "robot", names, experiment.simulation.tick_s, identity) as node:
        place = Place(addresses(arguments.address), arguments.speed, arguments.lockstep, arguments.state)
        assembly = Assembly(experiment, node, arguments.trial, place)
        agents = [assembly.agent(name) for name in names]
        if arguments.state:
            for agent, name in zip(agents, names, strict=True):
                _go_on(agent, name, arguments, node.run_id, str(identity.fingerprint))
        if not arguments.supervised:
            report_clock(node, topics.EVENT, names)
        try:
            node.run(partial(_step, agents))
        finally:
            _stop(agents)
            if arguments.keys:
                write_receipts(arguments.keys, names, node.received)


def _check(arguments: argparse.Namespace, experiment: Experiment, names: list[str]) -> None:
    """UserError about what would stop these robots once they are under way."""
    robots = tuple(experiment.robot_named(name) for name in names)
    require_good(arguments.experiment, robot_checks(experiment, robots))
    if arguments.state:
        _refuse_access(robots)
        require_good(arguments.experiment, [writable("--state", arguments.state)])


def _refuse_access(robots: tuple[RobotSettings, ...]) -> None:
    for robot in robots:
        if robot.accesses:
            raise UserError(
                f"--state: {robot.id!r} accesses the internal state of {robot.accesses!r}, which is not "
                "its own to keep: leave --state out"
            )


def _go_on(agent: Agent, name: str, arguments: argparse.Namespace, run_id: str, identity: str) -> None:
    text = agent.resume_from(Checkpoint(arguments.state, name, run_id, identity, arguments.other_run))
    if text:
        print(f"{name}: {text}", file=sys.stderr, flush=True)


def _step(agents: list[Agent], t_ns: int) -> None:
    """All wheels stand before the disk is waited for."""
    for agent in agents:
        agent.step(t_ns)
    for agent in agents:
        agent.keep_emergency()


def _stop(agents: list[Agent]) -> None:
    for agent in agents:
        agent.stop()


def _names(wanted: str, experiment: Experiment) -> list[str]:
    known = [robot.id for robot in experiment.robot]
    names = wanted.split(",") if wanted else []
    for name in names:
        if name not in known:
            raise UserError(f"--robot {name!r} is not in the experiment; {nearest(name, known)}")
    if not names:
        raise UserError(f"--robot is missing: say which robot this is; known: {', '.join(known)}")
    return names


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent",
        description="The process on a robot's board: it finds out where the robot is, decides, drives and "
        "learns. Start the swarm server and the tracker bridge first or later: the agent waits for them.",
        epilog="tools, each with --help: `robot-agent check` tries a real robot; `calibrate skirt`, "
        "`calibrate camera` and `calibrate wheels` learn a skirt's colour, a lens and a robot's dimensions; "
        "`emulate` stands in for a robot; `imitate` watches another robot and drives its pattern; "
        "`collect-copies` stores how well simulated robots copy.",
    )
    add_common_arguments(parser)
    parser.add_argument("--robot", default="", metavar="ID[,ID...]", help="which robot this is")
    add_address_argument(parser)
    parser.add_argument(
        "--calibration",
        type=place,
        metavar="FILE",
        help="this board's camera, in place of the experiment's calibration",
    )
    parser.add_argument(
        "--state",
        type=place,
        metavar="DIR",
        help="keep what was learnt here; after a restart in the same run the robot goes on from it",
    )
    parser.set_defaults(other_run=OtherRun.REFUSED)
    of_another_run = parser.add_mutually_exclusive_group()
    for option, choice, meaning in (
        ("--fresh", OtherRun.FRESH, "begin anew if --state is of another run; its file gets another name"),
        ("--resume", OtherRun.RESUMED, "go on from what was learnt in another run; the log tells of it"),
    ):
        of_another_run.add_argument(
            option, action="store_const", dest="other_run", const=choice, help=meaning
        )
    parser.add_argument(
        "--keys",
        type=place,
        metavar="FILE",
        help="write how much was received under every key, as JSON, at the end: `swarm check --firewall` "
        "adds it up",
    )
    return parser
