"""`swarm doctor`: can this experiment start on this machine?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_findings, print_json
from swarm.cli.values import Changes, good_place


def doctor_command(
    experiment: Annotated[Path, typer.Argument(help="An experiment file, such as deploy/sim/demo.toml.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Where the run would go.", show_default="runs/NAME-001 and so on", callback=good_place
        ),
    ] = None,
    changes: Changes = None,
    json: Annotated[bool, typer.Option("--json", help="Print the findings as one JSON object.")] = False,
) -> None:
    """Look at an experiment, its files and this machine, as every command does before it starts.

    Exit code 0: a simulation can start. 1: something is bad; the cure stands beside it. 2: the file is no
    experiment.
    """
    from swarm.checkup.checkup import findings
    from swarm.checkup.finding import any_bad
    from swarm.config.experiment import Experiment

    found = findings(Experiment.load(experiment, changes), out)
    if json:
        print_json({"experiment": str(experiment), "findings": [finding.as_json() for finding in found]})
    else:
        print_findings(found)
    if any_bad(found):
        raise typer.Exit(1)
