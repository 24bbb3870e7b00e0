"""The `swarm-server` command: more than the base install is imported only once it is known to be there."""

from __future__ import annotations

import sys

from swarm.cli.output import require_extra
from swarm.errors import guarded


def main() -> None:
    """Entry point of `swarm-server`."""
    sys.exit(guarded(_run))


def _run() -> None:
    require_extra("lab", "foxglove_schemas_protobuf", "rich", "small_mcap")
    from server.command import run

    run()
