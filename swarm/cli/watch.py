"""`swarm watch`: a run in the terminal, live or from its log."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.console import Connect, Place, Trial, source_of
from swarm.cli.steering import Insecure, Keys
from swarm.clock import unix_clock
from swarm.errors import RunFailedError, UserError
from swarm.extras import require_extra

if TYPE_CHECKING:
    from rich.console import RenderableType

    from swarm.console.polling import Polling
    from swarm.console.sources import Source

LOOK_EVERY_S = 0.5
"""A person sees twice a second what robots tell of themselves once."""


def watch_command(
    place: Place = None,
    trial: Trial = None,
    connect: Connect = "",
    keys: Keys = None,
    insecure: Insecure = False,
    move: Annotated[
        int | None, typer.Option(min=1, help="As it was after so many moves of the slowest learner.")
    ] = None,
) -> None:
    """Show a run in the terminal: robots, learning, health, the last events; until Ctrl-C or its end.

    A finished log is shown as it was at the end, or after `--move`. Elsewhere than on a terminal it is
    printed once.
    """
    require_extra("lab", "mcap", "rich")
    from rich.console import Console
    from rich.live import Live

    from swarm.console.polling import Polling
    from swarm.console.sources import POLL_S

    console = Console() if sys.stdout.isatty() else Console(width=160)
    with Polling(source_of(place, trial, connect, keys, insecure), POLL_S) as run:
        with Live(console=console, auto_refresh=False, transient=True) as shown:
            for _ in unix_clock().ticks(LOOK_EVERY_S):
                if run.trouble:
                    raise RunFailedError(run.trouble)
                if _is_whole(run.polled):
                    break
                if console.is_terminal:
                    shown.update(_table(run, None), refresh=True)
        console.print(_table(run, move))


def _is_whole(source: Source) -> bool:
    """Whether nothing more is to come: the log is read, or the trial that is listened to is over."""
    history = source.history
    over = bool(history and history.phases and history.phases[-1].phase == "ended")
    return source.is_read or (over and source.is_live)


def _table(run: Polling[Source], move: int | None) -> RenderableType:
    from swarm.console.terminal import run_table

    history = run.polled.history
    if history is None:
        return run.polled.state
    with history.lock:
        t_s = history.end_s if move is None else history.time_of_move(move)
        if t_s is None:
            raise UserError(f"--move {move}: not every learner has made so many moves")
        return run_table(history, run.polled.state, t_s)
