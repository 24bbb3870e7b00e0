"""What `swarm-server` does: it conducts an experiment, and records everything."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from rich.console import Console

from server.processes.environment import Environment, laboratory, require_emulation, simulated
from server.progress import RunProgress, print_summary
from server.run import Run
from server.run_directory import RunDirectory
from swarm.checkup.checkup import experiment_findings, findings
from swarm.checkup.finding import Level, require_good
from swarm.checkup.machine import room
from swarm.cli.output import print_json
from swarm.config import arguments
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.runtime.process import OneLineParser
from swarm.runtime.zenoh_session import Session, SessionSettings
from swarm.signals import leave_on_signals


def run() -> None:
    """Parse the command line and conduct the experiment."""
    conduct(_parser().parse_args())


def conduct(asked: argparse.Namespace) -> None:
    """Conduct the experiment's trials on simulated robots or, with --listen, on a laboratory's."""
    leave_on_signals()
    experiment = Experiment.load(asked.experiment)
    experiment = experiment.changed(asked.seed, asked.moves, asked.processes)
    _check(asked, experiment)
    with RunProgress(experiment, Console(stderr=True)) as progress, ExitStack() as open_session:
        trials: Sequence[int] = range(experiment.run.trials)
        environment: Environment = partial(
            simulated, experiment, asked.speed, progress.warn, emulate=asked.emulate
        )
        if not asked.listen:
            require_emulation(experiment, asked.speed, emulate=asked.emulate)
        else:
            settings = SessionSettings(asked.listen, hub=True, config=asked.zenoh_config)
            session = open_session.enter_context(Session(settings))
            trials = [asked.trial]
            _warn_of_bad(experiment, progress)
            environment = partial(laboratory, experiment, session, progress.warn)
        directory = RunDirectory.create(asked.out, experiment.run.name)
        summary = Run(experiment, asked.experiment, directory, environment, trials, progress).run()
    if asked.json:
        print_json(summary)
    else:
        print_summary(summary)


def _check(asked: argparse.Namespace, experiment: Experiment) -> None:
    """UserError about what would stop the run once it was under way; nothing has been made yet.

    What a laboratory's boards have is looked at again on the boards, by their agents.
    """
    if asked.listen and asked.speed is not None:
        raise UserError("--speed is for simulations: with --listen a run goes as fast as life")
    if asked.listen:
        out = asked.out or Path("runs") / experiment.run.name
        require_good(asked.experiment, room(experiment, out))
    else:
        require_good(asked.experiment, findings(experiment, asked.out))


def _warn_of_bad(experiment: Experiment, progress: RunProgress) -> None:
    """A driver that is not installed here may be so on a board."""
    for finding in experiment_findings(experiment):
        if finding.level is Level.BAD:
            progress.warn(f"{finding.about}: {finding}")


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="swarm-server",
        description="Runs an experiment and records everything: on simulated robots, whose processes it "
        "starts, or with --listen on the robots of a laboratory.",
    )
    parser.add_argument("experiment", type=Path, metavar="EXPERIMENT.toml", help="what is run")
    parser.add_argument(
        "--out", type=arguments.place, metavar="DIR", help="a new directory (runs/NAME-001 and so on)"
    )
    parser.add_argument("--seed", type=arguments.seed, metavar="N", help="in place of the experiment's")
    parser.add_argument("--moves", type=arguments.moves, metavar="N", help="in place of the experiment's")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")
    simulation = parser.add_argument_group("simulation")
    simulation.add_argument(
        "--processes", type=arguments.processes, metavar="N", help="for the robots; 0 gives each its own"
    )
    simulation.add_argument(
        "--speed",
        type=arguments.pace_or_max,
        metavar="max|X",
        help="max: lockstep, as fast as possible, repeatable (the default); X: so many times as fast as life",
    )
    simulation.add_argument(
        "--emulate",
        action="store_true",
        help="emulate the robots whose driver is serial, wifi, i2c or spi; needs --speed X",
    )
    real = parser.add_argument_group("laboratory")
    real.add_argument(
        "--listen",
        metavar="tcp/HOST:PORT",
        help="wait here for the robots' agents and the tracker bridge, for instance tcp/0.0.0.0:7447",
    )
    real.add_argument(
        "--trial",
        type=arguments.trial,
        default=0,
        metavar="N",
        help="a laboratory runs one trial at a time, from 0; the agents are started with the same number",
    )
    real.add_argument(
        "--zenoh-config", type=Path, metavar="FILE", help="Zenoh settings for TLS, users and access control"
    )
    return parser
