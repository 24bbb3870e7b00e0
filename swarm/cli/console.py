"""`swarm console`: a page that shows a run, live or from its log."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.errors import UserError
from swarm.extras import require_extra

if TYPE_CHECKING:
    from swarm.console.sources import Source

Place = Annotated[
    Path | None, typer.Argument(help="A run directory or a .mcap log, finished or being written.")
]
Trial = Annotated[int | None, typer.Option(min=0, help="Which of the run's trials.", show_default="the last")]
Connect = Annotated[str, typer.Option(metavar="ENDPOINT", help="Of a live run's server, tcp/HOST:PORT.")]
ZenohConfig = Annotated[Path | None, typer.Option(metavar="FILE", help="Zenoh settings for TLS and users.")]


def console_command(
    place: Place = None,
    trial: Trial = None,
    connect: Connect = "",
    zenoh_config: ZenohConfig = None,
    port: Annotated[int, typer.Option(min=0, max=65_535, help="Of the page; 0: any that is free.")] = 8765,
    listen: Annotated[str, typer.Option(help="The address that pages are opened under.")] = "127.0.0.1",
    certificate: Annotated[Path | None, typer.Option(help="PEM; wanted if others can reach it.")] = None,
    key: Annotated[Path | None, typer.Option(help="The certificate's key, PEM.")] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
) -> None:
    """Show a run in a browser: arena, learning, memory, visits, health, events, at any of its moments.

    A finished log is played; one that is being written, or a live run, is followed. No internet is needed.
    """
    require_extra("console", "starlette", "uvicorn", "websockets")
    require_extra("lab", "mcap")
    from swarm.console.feed import Feed
    from swarm.console.serving import Address, serve

    address = Address(listen, port, certificate, key)
    address.check()
    with Feed(source_of(place, trial, connect, zenoh_config)) as feed:
        serve(feed, address, steer=False, browse=browser)


def source_of(place: Path | None, trial: int | None, connect: str, zenoh_config: Path | None) -> Source:
    """The log or the live run that a command line names; UserError unless it names one of the two."""
    if bool(place) == bool(connect):
        raise UserError("say what to show: a RUN or LOG, or with --connect ENDPOINT a live run")
    if connect:
        from swarm.console.wire_source import WireSource
        from swarm.runtime.endpoint import check_endpoint

        check_endpoint(connect)
        return WireSource(connect, zenoh_config)
    from swarm.console.sources import LogSource, logs_of_trial

    assert place
    return LogSource(logs_of_trial(place, trial))
