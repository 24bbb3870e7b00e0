"""What `swarm-server` does: it conducts an experiment, and records everything."""

from __future__ import annotations

import argparse
import secrets
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rich.console import Console

from server.interrupted_run import InterruptedRun
from server.processes.environment import (
    Environment,
    laboratory,
    require_emulation,
    require_tracker,
    simulated,
)
from server.progress import RunProgress, print_summary
from server.run import Run, Simulation
from server.run_directory import RunDirectory
from server.trial import Onlooker, TrialResult
from swarm.access.zenoh_limits import hub_limits
from swarm.checkup.checkup import experiment_findings, findings
from swarm.checkup.finding import Level, require_good
from swarm.checkup.machine import room, writable
from swarm.cli.output import print_json
from swarm.config import arguments
from swarm.config.changes import add_set_option
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.parallel import check_scheduler
from swarm.runtime.process import OneLineParser, add_protection_arguments, session_settings
from swarm.runtime.zenoh_session import Session
from swarm.services.notification import ServiceManager
from swarm.signals import leave_on_signals

RUN_ID_BYTES = 6
"""12 digits: a laboratory's thousand runs share one with a probability of 2 in a billion."""


LIVE = "127.0.0.1:8765"
"""Where Foxglove and Lichtblick look first, on this machine."""


def run() -> None:
    """Parse the command line and conduct the experiment."""
    conduct(_parser().parse_args())


def conduct(asked: argparse.Namespace) -> None:
    """Conduct the experiment's trials on simulated robots or, with --listen, on a laboratory's."""
    leave_on_signals()
    plan = _resumed(asked) if asked.resume else _begun(asked)
    with RunProgress(plan.experiment, Console(stderr=True)) as progress, ExitStack() as stack:
        onlookers = _onlookers(asked, stack)
        environment = _environment(plan, asked, progress, stack)
        directory = plan.directory or RunDirectory.create(asked.out, plan.experiment.run.name)
        run = Run(
            plan.experiment,
            plan.file,
            directory,
            environment,
            plan.trials,
            progress,
            plan.run_id,
            plan.changes,
            min(asked.jobs, len(plan.trials)),
            asked.scheduler,
            plan.simulation,
            onlookers,
            dict(plan.results),
        )
        summary = run.run()
    if asked.json:
        print_json(summary)
    else:
        print_summary(summary)


@dataclass(frozen=True)
class Plan:
    """What is to be run, and for a run that goes on, where."""

    experiment: Experiment
    file: Path
    trials: Sequence[int]
    run_id: str
    changes: Sequence[str]
    """What `--set` says in place of the file's values."""
    simulation: Simulation | None
    results: Mapping[int, TrialResult] = field(default_factory=dict)
    directory: RunDirectory | None = None


def _environment(
    plan: Plan, asked: argparse.Namespace, progress: RunProgress, open_session: ExitStack
) -> Environment:
    """What the trials are played on."""
    if plan.simulation:
        how = plan.simulation
        return partial(simulated, plan.experiment, how.speed, progress.warn, emulate=how.emulate)
    robots = [robot.id for robot in plan.experiment.robot]
    settings = session_settings(asked, asked.listen, hub=True, limits=hub_limits(robots))
    session = open_session.enter_context(Session(settings))
    manager = ServiceManager.of_environment()
    manager.ready()
    _warn_of_bad(plan.experiment, progress)
    return partial(laboratory, plan.experiment, session, progress.warn, manager.going_on)


def _onlookers(asked: argparse.Namespace, stack: ExitStack) -> Sequence[Onlooker]:
    """The viewers that --live serves."""
    if not asked.live:
        return ()
    if asked.jobs > 1:
        raise UserError("--live shows one trial at a time: leave out --jobs")
    require_extra("live", "foxglove")
    from server.recording.live_viewers import live_viewers

    return [stack.enter_context(live_viewers(asked.live, insecure=asked.insecure))]


def _begun(asked: argparse.Namespace) -> Plan:
    if asked.experiment is None:
        raise UserError("EXPERIMENT.toml is missing: say what is run, or with --resume which run goes on")
    changes = _changes(asked)
    experiment = Experiment.load(asked.experiment, changes)
    experiment = experiment.changed(asked.seed, asked.moves, asked.processes)
    _check(asked, experiment)
    joinable = asked.listen or asked.speed
    run_id = secrets.token_hex(RUN_ID_BYTES) if joinable else ""
    if asked.listen:
        return Plan(experiment, asked.experiment, [asked.trial or 0], run_id, changes, None)
    simulation = Simulation(asked.speed, asked.emulate)
    trials = range(experiment.run.trials)
    return Plan(experiment, asked.experiment, trials, run_id, changes, simulation)


def _changes(asked: argparse.Namespace) -> list[str]:
    """What stands in place of the file's values, and in the file that the run keeps."""
    trials = [f"run.trials={asked.trials}"] if asked.trials else []
    return [*(asked.set or ()), *trials]


def _check(asked: argparse.Namespace, experiment: Experiment) -> None:
    """UserError about what would stop the run once it was under way; nothing has been made yet.

    What a laboratory's boards have is looked at again on the boards, by their agents.
    """
    if asked.listen:
        _refuse_speed(asked)
        out = asked.out or Path("runs") / experiment.run.name
        require_good(asked.experiment, room(experiment, out))
    else:
        _refuse_live_jobs(asked)
        require_good(asked.experiment, findings(experiment, asked.out))
        require_emulation(experiment, asked.speed, emulate=asked.emulate)
        require_tracker(experiment, asked.speed)


def _refuse_speed(asked: argparse.Namespace) -> None:
    if asked.speed is not None:
        raise UserError("--speed is for simulations: with --listen a run goes as fast as life")
    if asked.jobs > 1 or asked.trials:
        raise UserError("--trials and --jobs are for simulations: a laboratory runs one trial at a time")


def _refuse_live_jobs(asked: argparse.Namespace) -> None:
    check_scheduler(asked.scheduler)
    if asked.jobs > 1 and asked.speed is not None:
        raise UserError(
            "--jobs is for lockstep: with --speed X trials need the machine's time for themselves"
        )


def _resumed(asked: argparse.Namespace) -> Plan:
    own = ("experiment", "set", "out", "seed", "moves", "trial", "trials", "speed")
    given = [name for name in own if getattr(asked, name) is not None]
    if given:
        raise UserError(f"--resume goes on with a run as it was begun: leave out {', '.join(given)}")
    run = InterruptedRun.read(asked.resume)
    if run.simulation and asked.listen:
        raise UserError(f"{asked.resume}: was simulated; leave out --listen")
    if not run.simulation and not asked.listen:
        raise UserError(f"{asked.resume}: its robots are a laboratory's; say with --listen where to wait")
    require_good(asked.resume, [writable("--resume", asked.resume)])
    experiment = run.experiment.changed(processes=asked.processes)
    return Plan(
        experiment, run.file, run.trials, run.run_id, run.changes, run.simulation, run.results, run.directory
    )


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
    parser.add_argument("experiment", type=Path, nargs="?", metavar="EXPERIMENT.toml", help="what is run")
    add_set_option(parser)
    parser.add_argument(
        "--out", type=arguments.place, metavar="DIR", help="a new directory (runs/NAME-001 and so on)"
    )
    parser.add_argument("--seed", type=arguments.seed, metavar="N", help="in place of the experiment's")
    parser.add_argument("--moves", type=arguments.moves, metavar="N", help="in place of the experiment's")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")
    parser.add_argument(
        "--live",
        type=arguments.address,
        nargs="?",
        const=LIVE,
        metavar="HOST:PORT",
        help=f"after EXPERIMENT.toml: show the run in Foxglove or Lichtblick while it goes on (at {LIVE})",
    )
    parser.add_argument(
        "--resume",
        type=arguments.place,
        metavar="RUN_DIRECTORY",
        help="go on with a run whose server ended before it was complete; with --listen on a laboratory's "
        "robots, whose agents need no restart",
    )
    _add_simulation_options(parser)
    _add_laboratory_options(parser)
    add_protection_arguments(parser)
    return parser


def _add_simulation_options(parser: OneLineParser) -> None:
    simulation = parser.add_argument_group("simulation")
    simulation.add_argument(
        "--trials", type=arguments.trials, metavar="N", help="in place of the experiment's"
    )
    simulation.add_argument(
        "--jobs", type=arguments.jobs, default=1, metavar="N", help="trials at a time (%(default)s)"
    )
    simulation.add_argument(
        "--scheduler",
        default="processes",
        help="where several trials at a time are played: %(default)s, dask (a local cluster), or a Dask "
        "scheduler's address tcp://HOST:PORT whose workers see the run's directory",
    )
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


def _add_laboratory_options(parser: OneLineParser) -> None:
    real = parser.add_argument_group("laboratory")
    real.add_argument(
        "--listen",
        metavar="tls/HOST:PORT",
        help="wait here for the robots' agents and the tracker bridge, for instance tls/0.0.0.0:7447",
    )
    real.add_argument(
        "--trial",
        type=arguments.trial,
        metavar="N",
        help="a laboratory runs one trial at a time, from 0; the agents are started with the same number",
    )
