"""`swarm console`: a page that shows a run, live or from its log."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.steering import Insecure, Keys
from swarm.errors import UserError
from swarm.extras import require_extra

if TYPE_CHECKING:
    from swarm.console.controls import Controls
    from swarm.console.sources import Source
    from swarm.runtime.zenoh_session import SessionSettings

Place = Annotated[
    Path | None, typer.Argument(metavar="[RUN|LOG]", help="A run's directory or log, finished or not.")
]
Trial = Annotated[int | None, typer.Option(min=0, help="Which of the run's trials.", show_default="the last")]
Connect = Annotated[
    str, typer.Option(metavar="WHERE", help="A live run: tcp/HOST:PORT, its directory, a laboratory file.")
]


def console_command(
    place: Place = None,
    trial: Trial = None,
    connect: Connect = "",
    keys: Keys = None,
    insecure: Insecure = False,
    steer: Annotated[bool, typer.Option("--steer", help="Also print an address that may steer.")] = False,
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
    from swarm.console.controls import LOOK_EVERY_S
    from swarm.console.open_page import Shown
    from swarm.console.polling import Polling
    from swarm.console.serving import Address, serve
    from swarm.console.sources import POLL_S

    address = Address(listen, port, certificate, key)
    address.check()
    controls = _controls(connect or str(place or ""), keys, insecure, wanted=steer)
    with ExitStack() as stack:
        run = stack.enter_context(Polling(source_of(place, trial, connect, keys, insecure), POLL_S))
        if controls:
            stack.enter_context(Polling(controls, LOOK_EVERY_S))
        serve(Shown(run, controls), address, steer=steer, browse=browser)


def source_of(
    place: Path | None, trial: int | None, connect: str, keys: Path | None, insecure: bool
) -> Source:
    """The log or the live run that a command line names; UserError unless it names one of the two."""
    if bool(place) == bool(connect):
        raise UserError("say what to show: a RUN or LOG, or with --connect WHERE a live run")
    if connect:
        from swarm.console.wire_source import WireSource

        return WireSource(_settings(connect, keys, insecure))
    from swarm.console.sources import LogSource, logs_of_trial

    assert place
    return LogSource(logs_of_trial(place, trial))


def _controls(where: str, keys: Path | None, insecure: bool, *, wanted: bool) -> Controls | None:
    """Of a run whose server listens; UserError if it does not, and is wanted."""
    from swarm.console.controls import Controls

    try:
        return Controls(_settings(where, keys, insecure))
    except UserError as error:
        if wanted:
            raise UserError(f"--steer: {error}") from error
        return None


def _settings(where: str, keys: Path | None, insecure: bool) -> SessionSettings:
    """How to reach a live run; UserError already now if that cannot work, whether or not it is there yet."""
    from swarm.control.reaching import settings_of
    from swarm.runtime.endpoint import check_endpoint, check_protection

    settings = settings_of(where, credentials=keys, insecure=insecure)
    check_endpoint(settings.endpoint)
    check_protection(settings.endpoint, bool(settings.credentials), insecure)
    return settings
