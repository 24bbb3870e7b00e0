"""`swarm export`: a log for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from swarm.cli.output import print_json
from swarm.extras import require_extra
from swarm.files import printable


def export_command(
    log: Annotated[Path, typer.Argument(help="A .mcap file of a trial, or a run directory of one trial.")],
    to: Annotated[Literal["csv", "parquet", "rosbag2"], typer.Option(help="The format.")],
    out: Annotated[Path | None, typer.Option(help="The new folder.", show_default="LOG-FORMAT")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the files as one JSON object.")] = False,
) -> None:
    """Write a log as tables, a file each (tables.md says what is in them), or as a bag of ROS 2."""
    require_extra("lab", "mcap", "polars")
    if to == "rosbag2":
        require_extra("ros", "rosbags")
    from swarm.logs.export import Format, export_log

    folder = out or log.with_name(f"{log.stem}-{to}")
    files = export_log(log, Format(to), folder)
    if json:
        print_json({"log": printable(log), "to": to, "files": list(map(printable, files))})
        return
    for file in files:
        typer.echo(f"wrote {printable(file)}")
