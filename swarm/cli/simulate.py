"""`swarm simulate`: hands over to the swarm server, which starts and conducts the simulated robots."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from swarm.extras import require_extra
from swarm.interpreter import child_environment, module_command


def simulate_command(
    experiment: Annotated[
        Path, typer.Argument(help="The experiment file, for instance deploy/sim/demo.toml.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="A new directory for the run.", show_default="runs/NAME-001 and so on")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="In place of the experiment's seed.")] = None,
    moves: Annotated[
        int | None, typer.Option(help="In place of the experiment's moves of a learner.")
    ] = None,
    speed: Annotated[
        str, typer.Option(help="max: lockstep, repeatable; X: so many times as fast as life.")
    ] = "max",
    processes: Annotated[
        int | None, typer.Option(help="Processes for the robots; 0 gives each robot its own.")
    ] = None,
    emulate: Annotated[
        bool,
        typer.Option("--emulate", help="Emulate the robots whose driver is a real link; needs --speed X."),
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
) -> None:
    """Run a simulated swarm: separate processes for agents, tracker and server, and a complete log."""
    require_extra("lab", "small_mcap", "rich")
    options = {"--out": out, "--seed": seed, "--moves": moves, "--speed": speed, "--processes": processes}
    given = [f"{name}={value}" for name, value in options.items() if value is not None]
    flags = [flag for flag, wanted in (("--emulate", emulate), ("--json", json)) if wanted]
    command = module_command("server", str(experiment), *given, *flags)
    sys.stdout.flush()
    os.execve(sys.executable, command, child_environment())
