"""`swarm check`: is a log complete and sound?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.errors import RunFailedError
from swarm.extras import require_extra
from swarm.files import printable


def check_command(
    log: Annotated[Path, typer.Argument(help="A .mcap file.")],
    json: Annotated[bool, typer.Option("--json", help="Print the findings as one JSON object.")] = False,
) -> None:
    """Say whether a log is complete and sound: its index, checksums, gaps, duplicates, every message.

    Exit code 0: it is. 1: it is not, with the reasons. 2: it is no log of a run.
    """
    require_extra("lab", "mcap", "polars")
    from swarm.logs.check import check_log

    found = check_log(log)
    if json:
        print_json(found.as_json())
    else:
        for remark in found.remarks:
            typer.echo(f"note: {remark}")
    if found.faults:
        more = f"; and {len(found.faults) - 3} more" if len(found.faults) > 3 else ""
        raise RunFailedError(f"{printable(log)} is not sound: {'; '.join(found.faults[:3])}{more}")
    if not json:
        typer.echo(f"{printable(log)}: complete and sound, {found.messages:,} messages")
