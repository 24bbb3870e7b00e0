"""What `swarm-server` does: it conducts an experiment, and records everything."""

from __future__ import annotations

import argparse
import math
import secrets
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from rich.console import Console

from server.interrupted_run import InterruptedRun
from server.processes.environment import Environment, laboratory, simulated
from server.progress import RunProgress, print_summary
from server.run import Run
from server.run_directory import RunDirectory
from swarm.cli.output import print_json
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser, leave_on_signals
from swarm.runtime.zenoh_session import Session, SessionSettings

RUN_ID_BYTES = 6
"""12 digits: a laboratory's thousand runs share one with a probability of 2 in a billion."""


def run() -> None:
    """Parse the command line and conduct the experiment."""
    conduct(_parser().parse_args())


def conduct(arguments: argparse.Namespace) -> None:
    """Conduct the experiment's trials on simulated robots or, with --listen, on a laboratory's."""
    leave_on_signals()
    plan = _resumed(arguments) if arguments.resume else _begun(arguments)
    with RunProgress(plan.experiment, Console(stderr=True)) as progress, ExitStack() as open_session:
        trials: Sequence[int] = range(plan.experiment.run.trials)
        environment: Environment = partial(simulated, plan.experiment, arguments.speed, progress.warn)
        if arguments.listen:
            settings = SessionSettings(arguments.listen, hub=True, config=arguments.zenoh_config)
            session = open_session.enter_context(Session(settings))
            trials = [plan.trial]
            environment = partial(laboratory, plan.experiment, session, progress.warn)
        directory = plan.directory or RunDirectory.create(arguments.out, plan.experiment.run.name)
        run = Run(plan.experiment, plan.file, directory, environment, trials, progress, plan.run_id)
        summary = run.run()
    if arguments.json:
        print_json(summary)
    else:
        print_summary(summary)


@dataclass(frozen=True)
class Plan:
    """What is to be run, and for a run that goes on, where."""

    experiment: Experiment
    file: Path
    trial: int
    run_id: str
    directory: RunDirectory | None = None


def _begun(arguments: argparse.Namespace) -> Plan:
    if arguments.experiment is None:
        raise UserError("EXPERIMENT.toml is missing: say what is run, or with --resume which run goes on")
    experiment = Experiment.load(arguments.experiment)
    experiment = experiment.changed(arguments.seed, arguments.moves, arguments.processes)
    joinable = arguments.listen or arguments.speed
    run_id = secrets.token_hex(RUN_ID_BYTES) if joinable else ""
    return Plan(experiment, arguments.experiment, arguments.trial or 0, run_id)


def _resumed(arguments: argparse.Namespace) -> Plan:
    own = ("experiment", "out", "seed", "moves", "trial")
    given = [name for name in own if getattr(arguments, name) is not None]
    if given:
        raise UserError(f"--resume goes on with a run as it was begun: leave out {', '.join(given)}")
    if not arguments.listen:
        raise UserError("--resume waits for the robots of a laboratory: say where with --listen")
    run = InterruptedRun.read(arguments.resume)
    return Plan(run.experiment, run.file, run.trial, run.run_id, run.directory)


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="swarm-server",
        description="Runs an experiment and records everything: on simulated robots, whose processes it "
        "starts, or with --listen on the robots of a laboratory.",
    )
    parser.add_argument("experiment", type=Path, nargs="?", metavar="EXPERIMENT.toml", help="what is run")
    parser.add_argument("--out", type=Path, metavar="DIR", help="a new directory (runs/NAME-001 and so on)")
    parser.add_argument("--seed", type=_at_least(0), metavar="N", help="in place of the experiment's")
    parser.add_argument("--moves", type=_at_least(1), metavar="N", help="in place of the experiment's")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")
    simulation = parser.add_argument_group("simulation")
    simulation.add_argument(
        "--processes", type=_at_least(0), metavar="N", help="for the robots; 0 gives each its own"
    )
    simulation.add_argument(
        "--speed",
        type=_speed,
        metavar="max|X",
        help="max: lockstep, as fast as possible, repeatable (the default); X: so many times as fast as life",
    )
    real = parser.add_argument_group("laboratory")
    real.add_argument(
        "--listen",
        metavar="tcp/HOST:PORT",
        help="wait here for the robots' agents and the tracker bridge, for instance tcp/0.0.0.0:7447",
    )
    real.add_argument(
        "--trial",
        type=_at_least(0),
        metavar="N",
        help="a laboratory runs one trial at a time, from 0; the agents are started with the same number",
    )
    real.add_argument(
        "--resume",
        type=Path,
        metavar="RUN_DIRECTORY",
        help="go on with a run whose server ended before its trial did; the agents need no restart",
    )
    real.add_argument(
        "--zenoh-config", type=Path, metavar="FILE", help="Zenoh settings for TLS, users and access control"
    )
    return parser


def _at_least(low: int) -> Callable[[str], int]:
    def whole_number(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if not low <= value < 2**63:
            raise argparse.ArgumentTypeError(f"{text!r} is no whole number of at least {low}")
        return value

    return whole_number


def _speed(text: str) -> float | None:
    if text == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = math.nan
    if not 0.01 <= speed <= 1000:
        raise argparse.ArgumentTypeError(f"{text!r} is neither max nor a number from 0.01 to 1000")
    return speed
