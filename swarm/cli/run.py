"""`swarm run`: an experiment in a laboratory, from the server's machine."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Annotated

import typer

from swarm.cli.status import LOOK_EVERY_S, watch
from swarm.cli.steering import Insecure
from swarm.cli.values import checked, good_place
from swarm.config import arguments
from swarm.extras import require_extra

if TYPE_CHECKING:
    from subprocess import Popen


def run_command(
    experiment: Annotated[Path, typer.Argument(help="The experiment file, as it is on the boards.")],
    lab: Annotated[Path, typer.Option(help="The laboratory file, such as deploy/lab.toml.")],
    out: Annotated[
        Path | None, typer.Option(help="A new directory.", show_default="runs/NAME-001", callback=good_place)
    ] = None,
    trial: Annotated[
        str, typer.Option(metavar="N", help="Its number, from 0.", callback=checked(arguments.trial))
    ] = "0",
    insecure: Insecure = False,
    json: Annotated[bool, typer.Option("--json", help="Print the result as one JSON object.")] = False,
) -> None:
    """Start the server, and the tracker bridge if it is hosted here; wait for the robots; show the run.

    Ctrl-C ends the trial in order. The exit code is the server's: 0 if the trial is complete or was stopped.
    A server that conducts this run already, as a service, is left alone and shown.
    """
    require_extra("lab", "small_mcap", "rich")
    from swarm.control.laboratory_run import LaboratoryRun, is_under_way

    if is_under_way(lab, experiment, int(trial), insecure=insecure):
        typer.echo(f"a server conducts this run already; see it with `swarm status --at {lab}`")
        return
    options = [f"--out={out}"] if out else []
    options += ["--json"] if json else []
    run = LaboratoryRun.of(lab, experiment, options, ["--trial", trial], insecure=insecure)
    if json or not sys.stdout.isatty():
        with run.started(None) as server:
            code = server.wait()
    else:
        with TemporaryFile() as messages:
            with run.started(messages) as server:
                _show(server, str(lab), insecure)
                code = server.wait()
            messages.seek(0)
            sys.stderr.write(messages.read().decode(errors="replace") if code else "")
    raise typer.Exit(code)


def _show(server: Popen[bytes], lab: str, insecure: bool) -> None:
    """How it goes, from when the server listens until it ends."""
    from swarm.clock import unix_clock
    from swarm.control.reaching import settings_of
    from swarm.errors import UserError
    from swarm.runtime.zenoh_session import Session

    for _ in unix_clock().ticks(LOOK_EVERY_S):
        if server.poll() is not None:
            return
        try:
            with Session(settings_of(lab, insecure=insecure)) as session:
                watch(session)
                return
        except UserError:
            continue
