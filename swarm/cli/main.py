"""The `swarm` command: it only lists the verbs; each verb lives in the file of its name."""

from __future__ import annotations

import sys
from io import TextIOWrapper

from swarm.errors import guarded
from swarm.extras import require_extra


def _run() -> None:
    require_extra("lab", "typer", "rich")
    from swarm.cli.app import run

    run()


def main() -> None:
    """Entry point of the `swarm` command. A name that is not UTF-8 is printed with escapes."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    sys.exit(guarded(_run))
