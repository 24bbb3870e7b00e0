"""`swarm status`: how a live run goes."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from swarm.cli.output import print_json
from swarm.cli.steering import At, Insecure, Json, Keys, steering
from swarm.extras import require_extra
from swarm.runtime.endpoint import DEFAULT_ENDPOINT

if TYPE_CHECKING:
    from swarm.runtime.zenoh_session import Session

LOOK_EVERY_S = 0.5
"""A person sees twice a second what robots tell of themselves once."""


def status_command(
    at: At = DEFAULT_ENDPOINT, keys: Keys = None, insecure: Insecure = False, json: Json = False
) -> None:
    """Show how a live run goes: live on a terminal until Ctrl-C or the run's end, else once."""
    require_extra("lab", "rich")
    from rich.console import Console

    from swarm.control.status_table import status_table
    from swarm.runtime.operating import ask_status, status_as_json

    with steering(at, keys, insecure) as session:
        if json:
            print_json(status_as_json(ask_status(session)))
        elif sys.stdout.isatty():
            watch(session)
        else:
            Console(width=200).print(status_table(ask_status(session)))


def watch(session: Session) -> None:
    """Show it until the run ends."""
    from rich.live import Live

    from swarm.clock import unix_clock
    from swarm.control.status_table import status_table
    from swarm.errors import UserError
    from swarm.runtime.operating import ask_status

    with Live(status_table(ask_status(session)), auto_refresh=False) as shown:
        for _ in unix_clock().ticks(LOOK_EVERY_S):
            try:
                shown.update(status_table(ask_status(session)), refresh=True)
            except UserError:
                break
    print("the run has ended, or its server is gone")
