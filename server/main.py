"""The `swarm-server` command: more than the base install is imported only once it is known to be there."""

from __future__ import annotations

import sys

from swarm.errors import guarded
from swarm.extras import require_extra


def main() -> None:
    """Entry point of `swarm-server`."""
    sys.exit(guarded(_run))


def _run() -> None:
    require_extra("lab", "foxglove_schemas_protobuf", "rich", "small_mcap", "tomlkit")
    from server.command import run

    run()
