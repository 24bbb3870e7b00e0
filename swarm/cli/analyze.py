"""`swarm analyze`: logs to tables, learning curves and a report."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.extras import require_extra

if TYPE_CHECKING:
    from swarm.analysis.analyze import Analysis


def analyze_command(
    run: Annotated[list[Path], typer.Argument(help="Run directories or .mcap files; several are pooled.")],
    out: Annotated[
        Path | None,
        typer.Option(
            help="Where results go: new, or holding results of the very same logs.",
            show_default="RUN/analysis",
            callback=good_place,
        ),
    ] = None,
    samples: Annotated[
        bool,
        typer.Option(help="Also tables of poses, commands and truths. Without them it takes half the time."),
    ] = True,
    threshold: Annotated[
        int, typer.Option(min=1, help="The path length, in moves, that counts as a good path.")
    ] = 12,
    html: Annotated[
        bool, typer.Option("--html", help="Also report.html: one file to hand round, for any browser.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the results as one JSON object.")] = False,
) -> None:
    """Turn logs into tables (Parquet), learning curves (PNG, CSV, Parquet) and a report (Markdown).

    Trials of the same condition are pooled; the interval is the 95 % interval of the mean over trials.
    """
    require_extra("lab", "mcap", "polars", "matplotlib", "scipy", "rich")
    from swarm.analysis.analyze import Request, analyze

    with _progress() as show:
        analysis = analyze(Request(run, out, samples, threshold, html), show)
    if json:
        print_json(analysis.as_json())
    else:
        print_analysis(analysis)


def print_analysis(analysis: Analysis) -> None:
    """The summary as a table, what a reader must know, and where the files are."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from swarm.analysis.report import condition_head, condition_rows, sentence

    summary, console = analysis.summary, Console(highlight=False)
    table = Table(box=box.SIMPLE_HEAD, title=summary.title, title_justify="left", pad_edge=False)
    for place, name in enumerate(condition_head(summary)):
        table.add_column(name, justify="left" if place == 0 else "right", no_wrap=place == 0)
    for row in condition_rows(summary):
        table.add_row(*row)
    console.print(table)
    for found in summary.comparisons:
        console.print(sentence(found).replace("**", ""), markup=False)
    for note in summary.notes:
        console.print(f"note: {note}", markup=False)
    for name in ("report.md", "curves.png", "report.html"):
        if name not in analysis.files:
            continue
        console.print(f"wrote {analysis.files[name]}", markup=False, soft_wrap=True)


@contextmanager
def _progress() -> Iterator[Callable[[int], object]]:
    """Counts messages on a terminal; says nothing elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.completed:,.0f} messages read"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=None)
        yield lambda messages: bar.advance(task, messages)
