"""`swarm simulate`: hands over to the swarm server, which starts and conducts the simulated robots."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.values import Changes, Scheduler, checked, good_place
from swarm.config import arguments
from swarm.extras import require_extra
from swarm.interpreter import child_environment, module_command
from swarm.signals import leave_at_once

ExperimentFile = Annotated[
    Path | None, typer.Argument(help="The experiment file, for instance deploy/sim/demo.toml.")
]
Out = Annotated[
    Path | None,
    typer.Option(
        help="A new directory for the run.",
        show_default="runs/NAME-001 and so on",
        callback=good_place,
    ),
]
Seed = Annotated[
    str | None,
    typer.Option(metavar="N", help="In place of the experiment's seed.", callback=checked(arguments.seed)),
]
Moves = Annotated[
    str | None,
    typer.Option(
        metavar="N",
        help="In place of the experiment's moves of a learner.",
        callback=checked(arguments.moves),
    ),
]
Speed = Annotated[
    str,
    typer.Option(
        metavar="max|X",
        help="max: lockstep, repeatable; X: so many times as fast as life.",
        callback=checked(arguments.pace_or_max),
    ),
]
Trials = Annotated[
    str | None,
    typer.Option(
        metavar="N",
        help="In place of the experiment's trials.",
        callback=checked(arguments.trials),
    ),
]
Jobs = Annotated[str, typer.Option(metavar="N", help="Trials at a time.", callback=checked(arguments.jobs))]
Processes = Annotated[
    str | None,
    typer.Option(
        metavar="N",
        help="Processes for the robots; 0 gives each robot its own.",
        callback=checked(arguments.processes),
    ),
]
Emulate = Annotated[
    bool,
    typer.Option("--emulate", help="Emulate the robots whose driver is a real link; needs --speed X."),
]
Resume = Annotated[
    Path | None,
    typer.Option(
        metavar="RUN",
        help="In place of an experiment: a run that was interrupted. Its finished trials are kept, the "
        "others are done.",
        callback=good_place,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")]


def simulate_command(
    experiment: ExperimentFile = None,
    out: Out = None,
    changes: Changes = None,
    seed: Seed = None,
    moves: Moves = None,
    speed: Speed = arguments.MAX,
    trials: Trials = None,
    jobs: Jobs = "1",
    scheduler: Scheduler = "processes",
    processes: Processes = None,
    emulate: Emulate = False,
    resume: Resume = None,
    json: Json = False,
) -> None:
    """Run a simulated swarm: separate processes for agents, tracker and server, and a complete log."""
    leave_at_once()
    require_extra("lab", "small_mcap", "rich", "tomlkit")
    options = {"--out": out, "--seed": seed, "--moves": moves, "--processes": processes, "--resume": resume}
    options |= {"--trials": trials, "--jobs": jobs, "--scheduler": scheduler}
    if not (resume and speed == arguments.MAX):
        options["--speed"] = speed
    given = [f"{name}={value}" for name, value in options.items() if value is not None]
    given += [f"--set={change}" for change in changes or ()]
    flags = [flag for flag, wanted in (("--emulate", emulate), ("--json", json)) if wanted]
    file = [str(experiment)] if experiment else []
    command = module_command("server", *file, *given, *flags)
    sys.stdout.flush()
    os.execve(sys.executable, command, child_environment())
