"""`swarm compare`: the learning curves of runs over each other, and tests of every two."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.extras import require_extra
from swarm.files import printable

if TYPE_CHECKING:
    from swarm.analysis.run_comparison import RunComparison


def compare_command(
    run: Annotated[list[Path], typer.Argument(help="Two or more run directories or .mcap files.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Where picture, table and report go: new, or of the very same logs.",
            show_default="runs/comparisons/RUN-RUN",
            callback=good_place,
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the comparison as one JSON object.")] = False,
) -> None:
    """Lay the learning curves of runs over each other, and test every two conditions of all runs.

    Tests are of pairs with the same seed and trial, all of them together at 5 %. Each with its effect size.
    """
    require_extra("lab", "mcap", "polars", "matplotlib", "scipy", "rich")
    from swarm.analysis.run_comparison import compare_runs, default_place, write_comparison

    found, inputs = compare_runs(run)
    files = write_comparison(found, inputs, out or default_place(run))
    if json:
        print_json(found.as_json() | {"files": {name: printable(path) for name, path in files.items()}})
    else:
        _print(found, list(files.values()))


def _print(found: RunComparison, files: list[Path]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from swarm.analysis.run_comparison import CURVE_HEAD, curve_rows, level_note, pair_line

    console = Console(highlight=False)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for place, name in enumerate(CURVE_HEAD):
        table.add_column(name, justify="right" if place else "left")
    for row in curve_rows(found):
        table.add_row(*map(Text, row))
    console.print(table)
    lines = [pair_line(pair) for pair in found.pairs]
    lines += [level_note(found).replace("`", "")] if found.pairs else []
    lines += [f"not tested: {pair.reason}" for pair in found.untested]
    lines += [f"note: {note}" for note in found.curves.notes]
    for line in lines:
        console.print(line, markup=False)
    for file in files:
        console.print(f"wrote {printable(file)}", markup=False, soft_wrap=True)
