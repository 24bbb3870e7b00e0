"""What a console reads of a log, all of it."""

from __future__ import annotations

from pathlib import Path

from swarm.console.run_history import RunHistory
from swarm.console.sources import LogSource


def history_of(*logs: Path) -> RunHistory:
    """The history of a trial whose logs are closed."""
    source = LogSource(logs)
    while not source.is_read:
        source.poll()
    source.close()
    return source.history
