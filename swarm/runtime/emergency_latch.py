"""An emergency stop that outlives the process that heard it: in force until somebody releases it."""

from __future__ import annotations

import os
from pathlib import Path

from swarm.errors import one_line

LONGEST_NAME, LONGEST_REASON = 64, 200
"""Letters of what a person says beside an order: together a line of the log."""


def by(operator: str, reason: str) -> str:
    """Who ordered something, and why if they said it."""
    who = one_line(operator, LONGEST_NAME) or "somebody"
    return f"{who} ({one_line(reason, LONGEST_REASON)})" if reason else who


class EmergencyLatch:
    """One file: while it is there the emergency is in force, whatever stands in it.

    The server keeps one in the run's directory and every robot one beside its state. Without a file the
    latch lasts as long as the process.
    """

    def __init__(self, file: Path | None) -> None:
        self._file = file
        self.reason = ""
        """Who stopped everybody, and why."""
        self.engaged = file is not None and file.exists()
        self._kept = self.engaged
        if self.engaged and file is not None:
            self.reason = file.read_text(encoding="utf-8", errors="replace").strip()

    def engage(self, reason: str) -> bool:
        """Put it in force, in memory alone: wheels stop before a disk is waited for. False if it was."""
        if self.engaged:
            return False
        self.engaged, self.reason = True, reason
        return True

    def keep(self) -> None:
        """Bring what is in force to the disk; OSError if that is impossible, once."""
        if self._kept or not self.engaged:
            return
        self._kept = True
        if self._file is None:
            return
        self._file.parent.mkdir(parents=True, exist_ok=True)
        with self._file.open("w", encoding="utf-8") as file:
            file.write(f"{self.reason}\n")
            file.flush()
            os.fsync(file.fileno())

    def release(self) -> None:
        """The emergency is over."""
        if self._file is not None:
            self._file.unlink(missing_ok=True)
        self.engaged = self._kept = False
        self.reason = ""
