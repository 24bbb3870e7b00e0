"""`swarm recover`: a damaged log, or one whose recorder was killed, made whole."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from swarm.cli.output import print_json
from swarm.cli.values import good_place
from swarm.extras import require_extra
from swarm.files import printable


def recover_command(
    log: Annotated[Path, typer.Argument(help="A .mcap file.")],
    out: Annotated[
        Path | None, typer.Option(help="The new file (LOG with .recovered.mcap).", callback=good_place)
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
) -> None:
    """Copy all that can be read of a log into a new file with an index; the old one stays as it is.

    Exit code 0, with what could not be read. 2: it is no log, or nothing can be read.
    """
    require_extra("lab", "mcap", "small_mcap")
    from swarm.logs.recover import recover_log
    from swarm.logs.trial_logs import closed_path

    whole = out or closed_path(log).with_suffix(".recovered.mcap")
    found = recover_log(log, whole)
    if json:
        print_json({"log": printable(whole), "messages": found.messages, "lost": list(map(str, found.lost))})
        return
    for reason in found.lost:
        typer.echo(f"not read: {reason}")
    typer.echo(f"wrote {printable(whole)}: {found.messages:,} messages")
