"""The thread on which a source fills its history, beside whoever shows it."""

from __future__ import annotations

import threading

from swarm.console.sources import Source
from swarm.errors import RunFailedError, UserError

POLL_S = 0.02
"""Below the period of a frame; a log that is read from disk is polled without a pause until it is read."""


class Feed:
    """Polls a source for as long as the block lasts; `trouble` is why it had to stop, in words."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.trouble = ""
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True, name="console-feed")

    def __enter__(self) -> Feed:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()
        self.source.close()

    @property
    def state(self) -> str:
        """For people: what became of the source, or how it does."""
        return self.trouble or self.source.state

    def _run(self) -> None:
        try:
            while not self._stopped.is_set():
                if not self.source.poll():
                    self._stopped.wait(POLL_S)
        except (UserError, RunFailedError, OSError) as error:
            self.trouble = str(error)
