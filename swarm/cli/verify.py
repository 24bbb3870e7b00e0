"""`swarm verify`: are the numbers of a report those of its logs?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.errors import RunFailedError
from swarm.extras import require_extra
from swarm.files import printable

SHOWN = 5
"""Numbers that differ in one line; more are counted."""


def verify_command(
    report: Annotated[Path, typer.Argument(help="The report.html of `swarm analyze --html`.")],
    run: Annotated[
        list[Path] | None,
        typer.Argument(help="Its runs.", show_default="where they lay from the report when it was made"),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the findings as one JSON object.")] = False,
) -> None:
    """Make every number of a report once more from its logs, and name those that differ.

    Exit code 0: all are the same. 1: some differ. 2: it is no report, or its logs are not there.
    """
    require_extra("lab", "mcap", "polars", "matplotlib", "scipy")
    from swarm.analysis.analyze import verify

    found = verify(report, run or [])
    if json:
        print_json(found.as_json())
    if found.differences:
        shown = "; ".join(map(str, found.differences[:SHOWN]))
        more = len(found.differences) - SHOWN
        raise RunFailedError(f"{printable(report)}: {shown}{f'; and {more} more' if more > 0 else ''}")
    if not json:
        typer.echo(f"{printable(report)}: all {found.numbers:,} numbers are those of the logs")
        if not found.own_script:
            typer.echo("note: the page has another script than this version's: it may show them otherwise")
