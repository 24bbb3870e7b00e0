"""The `robot-agent` command: one process on a robot's board, or one that hosts simulated robots."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from robot_agent.agent import Agent
from robot_agent.assembly import Assembly
from robot_agent.checkpoint import Checkpoint
from swarm.errors import UserError, nearest
from swarm.experiment import Experiment
from swarm.guard import guarded
from swarm.process import OneLineParser, add_common_arguments, joined, leave_on_signals, load_experiment


def main() -> None:
    """Entry point of `robot-agent`."""
    sys.exit(guarded(lambda: run(_parser().parse_args())))


def run(arguments: argparse.Namespace) -> None:
    """Join the swarm and step the robots until the run ends or the process is told to leave."""
    experiment = load_experiment(arguments)
    names = _names(arguments.robot, experiment)
    leave_on_signals()
    with joined(arguments, "robot", names, experiment.simulation.tick_s) as link:
        assembly = Assembly(experiment, link, arguments.trial)
        agents = [assembly.agent(name) for name in names]
        if arguments.state:
            run = f"{experiment.run.name}, seed {experiment.run.seed}, trial {arguments.trial}"
            for agent, name in zip(agents, names, strict=True):
                agent.resume_from(Checkpoint(arguments.state, name, run))
        try:
            for t_ns in link.ticks():
                for agent in agents:
                    agent.step(t_ns)
        finally:
            _stop(agents)


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
    )
    add_common_arguments(parser)
    parser.add_argument("--robot", default="", metavar="ID[,ID...]", help="which robot this is")
    parser.add_argument(
        "--state",
        type=Path,
        metavar="DIR",
        help="keep what was learnt here; go on from it after a restart",
    )
    return parser
