"""`swarm replay`: the learning in a log once more, bit by bit, or as it would have been."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.output import print_json
from swarm.errors import RunFailedError, UserError
from swarm.extras import require_extra
from swarm.files import printable

if TYPE_CHECKING:
    from swarm.replay.replay import LogReplay


def replay_command(
    log: Annotated[
        list[Path], typer.Argument(help="A run directory of one trial, or all .mcap files of a trial.")
    ],
    robot: Annotated[str, typer.Option(help="Of this learner alone.", show_default="all")] = "",
    at: Annotated[
        int | None, typer.Option(min=1, help="Stop after so many moves, and tell Q, memory, R.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="With --at: a directory for Q as CSV and PNG.")] = None,
    changes: Annotated[
        list[str] | None, typer.Option("--with", help="NAME=VALUE of [learning]: what if? May be repeated.")
    ] = None,
    without_path: Annotated[
        list[int] | None, typer.Option(help="What if this path had not been remembered? May be repeated.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
) -> None:
    """Feed what was observed to the learner once more, and compare each decision and value, bit for bit.

    Exit code 0: all equal, or a counterfactual was asked for. 1: something differs. 2: it is no log of a run.
    """
    require_extra("lab", "mcap", "polars", "matplotlib")
    from swarm.replay.changes import changes_of
    from swarm.replay.replay import Request, replay_log

    if out and at is None:
        raise UserError("--out takes the Q-table at a move: say which with --at MOVE")
    request = Request(tuple(log), robot, at, changes_of(changes or []), without_path or [])
    found = replay_log(request)
    files = _write(found, out) if out else []
    if json:
        print_json(found.as_json() | {"files": list(map(printable, files))})
    else:
        _print(found, files)
    if not found.is_identical and not request.is_counterfactual:
        differ = [f"{name}: {each.first}" for name, each in found.replays.items() if each.first]
        raise RunFailedError(f"{printable(log[0])} is not what this learner would do: {'; '.join(differ)}")


def _write(found: LogReplay, out: Path) -> list[Path]:
    from swarm.replay.pictures import write_moment

    grid, move = found.recording.identity.grid, found.request.at
    return [
        file
        for robot, replay in found.replays.items()
        for file in write_moment(out, f"{robot}-move-{move}", replay.learner.controller.q, grid)
    ]


def _print(found: LogReplay, files: list[Path]) -> None:
    for remark in found.recording.remarks:
        typer.echo(f"note: {remark}")
    for robot, replay in found.replays.items():
        typer.echo(f"{robot}: {replay.moves:,} moves, {replay.first or 'all equal'}")
        if found.request.is_counterfactual and replay.diverged:
            typer.echo(f"  from move {replay.diverged.move} on it is another story: {replay.diverged}")
    for robot, replay in found.replays.items() if found.request.at is not None else ():
        for each in replay.learner.controller.memory.remembered:
            ratio = replay.learner.controller.memory.ratio(each)
            typer.echo(f"{robot}: path {each.number}, {each.path}, R {ratio:.3f}")
    for file in files:
        typer.echo(f"wrote {printable(file)}")
