"""`swarm runs`: which runs there are, and what came of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.files import printable
from swarm.markdown import text_number

if TYPE_CHECKING:
    from swarm.logs.runs import RunEntry

COMMIT_SIGNS = 7
"""Of a commit: enough to tell those of one project apart."""


def runs_command(
    directory: Annotated[Path, typer.Argument(help="Where the runs are, or one run.")] = Path("runs"),
    json: Annotated[bool, typer.Option("--json", help="Print the runs as one JSON object.")] = False,
) -> None:
    """List runs: state, conditions, moves, the path that was learnt, and the program's commit.

    A run whose server was killed is told from one that goes on: its directory is held by nobody.
    """
    require_extra("lab", "mcap")
    from swarm.logs.runs import runs_in

    found = runs_in(directory)
    if json:
        print_json({"directory": printable(directory), "runs": [entry.as_json() for entry in found]})
    elif not found:
        raise UserError(f"{printable(directory)}: holds no run (a directory with manifest.json)")
    else:
        _print(found)


def _print(found: list[RunEntry]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("run", overflow="fold")
    for column in ("state", "trials", "moves", "path at the end", "commit"):
        right = column in ("trials", "moves")
        table.add_column(column, justify="right" if right else "left", no_wrap=True)
    for entry in found:
        table.add_row(*map(Text, _row(entry)))
    console = Console(highlight=False, markup=False)
    console.print(table)
    for entry in found:
        if entry.changes:
            console.print(f"{_short(entry)}: set {', '.join(entry.changes)}")


def _row(entry: RunEntry) -> list[str]:
    """A line for each condition's path."""
    results = {condition: entry.results.get(condition) for condition in entry.conditions}
    commit, _, changed = entry.commit.partition("+")
    return [
        _short(entry),
        entry.state,
        f"{entry.complete}/{entry.trials}",
        f"{entry.moves:,}",
        "\n".join(f"{name} {text_number(length)}" for name, length in results.items()),
        commit[:COMMIT_SIGNS] + ("+" if changed else ""),
    ]


def _short(entry: RunEntry) -> str:
    return printable(Path(entry.path.resolve().name))
