"""The `swarm` command: it only lists the verbs; each verb lives in the file of its name."""

from __future__ import annotations

import sys

from swarm.cli.output import require_extra
from swarm.errors import guarded


def _run() -> None:
    require_extra("lab", "typer", "rich")
    from swarm.cli.app import run

    run()


def main() -> None:
    """Entry point of the `swarm` command."""
    sys.exit(guarded(_run))
