"""Brings a file to the disk itself at a bounded interval, so that a power cut costs a moment and no more."""

from __future__ import annotations

import os
import threading

SYNC_EVERY_S = 1.0
"""Seconds of messages that a power cut may cost."""


class DiskSync:
    """Syncs on a thread of its own: a slow disk may take seconds, and nobody waits for it."""

    def __init__(self, descriptor: int, period_s: float = SYNC_EVERY_S) -> None:
        self._descriptor = descriptor
        self._period_s = period_s
        self._over = threading.Event()
        self.synced = threading.Event()
        """Set after the first time."""
        self.failure: OSError | None = None
        """Why the disk could not take the file."""
        self._thread = threading.Thread(target=self._run, name="disk-sync", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Sync for the last time; the file must still be open."""
        self._over.set()
        self._thread.join()
        self._sync()

    def _run(self) -> None:
        while not self._over.wait(self._period_s):
            self._sync()

    def _sync(self) -> None:
        try:
            os.fdatasync(self._descriptor)
        except OSError as error:
            self.failure = error
        self.synced.set()
