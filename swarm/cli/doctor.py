"""`swarm doctor`: can this experiment start on this machine?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import Changes, good_place

if TYPE_CHECKING:
    from swarm.checkup.finding import Finding


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
    from swarm.checkup.finding import Level
    from swarm.config.experiment import Experiment

    found = findings(Experiment.load(experiment, changes), out)
    if json:
        print_json({"experiment": str(experiment), "findings": [finding.as_json() for finding in found]})
    else:
        _print_table(found)
    if any(finding.level is Level.BAD for finding in found):
        raise typer.Exit(1)


COLOURS = {"good": "green", "warning": "yellow", "bad": "red"}


def _print_table(found: list[Finding]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in ("", "what", "found", "cure"):
        table.add_column(column)
    for finding in found:
        level = Text(finding.level.value, style=COLOURS[finding.level.value])
        table.add_row(level, Text(finding.about), Text(finding.text), Text(finding.cure))
    Console().print(table)
