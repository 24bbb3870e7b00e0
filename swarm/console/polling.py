"""Threads on which a console hears of a run, beside whoever shows it."""

from __future__ import annotations

import threading
from typing import Generic, Protocol, TypeVar

from swarm.errors import RunFailedError, UserError


class Polled(Protocol):
    """Something that has news from time to time."""

    def poll(self) -> bool:
        """Take in what is new; whether there was anything, so that more may be there at once."""

    def close(self) -> None:
        """Let go of it."""


P = TypeVar("P", bound=Polled)


class Polling(Generic[P]):
    """Polls one thing for as long as the block lasts; `trouble` is why that had to stop, in words."""

    def __init__(self, polled: P, pause_s: float) -> None:
        self.polled = polled
        self.trouble = ""
        self._pause_s = pause_s
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Polling[P]:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()
        self.polled.close()

    def _run(self) -> None:
        try:
            while not self._stopped.is_set():
                if not self.polled.poll():
                    self._stopped.wait(self._pause_s)
        except (UserError, RunFailedError, OSError) as error:
            self.trouble = str(error)
