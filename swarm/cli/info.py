"""`swarm info`: what is in a log, at once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.extras import require_extra
from swarm.files import printable

if TYPE_CHECKING:
    from swarm.logs.info import LogInfo


def info_command(
    log: Annotated[list[Path], typer.Argument(help="MCAP files of any program, or run directories.")],
    json: Annotated[bool, typer.Option("--json", help="Print it as one JSON object.")] = False,
) -> None:
    """Say what a log holds: messages, topics, times, state, and whose run it is.

    By the log's index if its checksum is right, which takes no longer for a large log; else by reading it.
    """
    require_extra("lab", "mcap")
    from swarm.logs.info import logs_named, read_info

    found = [read_info(path) for path in logs_named(log)]
    if not json:
        for info in found:
            _print(info)
    elif len(found) == 1 and not log[0].is_dir():
        print_json(found[0].as_json())
    else:
        total = sum(info.messages for info in found)
        print_json({"messages": total, "logs": [info.as_json() for info in found]})


def _print(info: LogInfo) -> None:
    how = "by its index" if info.by_index else "read through, since no index with a right checksum says it"
    typer.echo(
        f"{printable(info.path)}: {info.messages:,} messages, {info.duration_s:.1f} s, {info.state} ({how})"
    )
    if info.run:
        typer.echo(f"  run {info.run['name']}, seed {info.run['seed']}, trial {info.run['trial']}")
        for change in info.run["set"]:
            typer.echo(f"  set {change}")
    if info.trial_ended:
        typer.echo(f"  the trial was {info.trial_ended['state']} {info.trial_ended['reason']}".rstrip())
    for reason in info.damage:
        typer.echo(f"  note: {reason}")
    _print_topics(info)


def _print_topics(info: LogInfo) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("topic", overflow="fold")
    table.add_column("messages", justify="right")
    table.add_column("per s", justify="right")
    table.add_column("schema")
    for name, topic in info.topics.items():
        rate_hz = info.rate_hz(name)
        rate = "" if rate_hz is None else f"{rate_hz:.2f}"
        table.add_row(name, f"{topic.messages:,}", rate, topic.schema or topic.encoding)
    Console(highlight=False, markup=False).print(table)
