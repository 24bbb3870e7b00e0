"""Calls that may block for ever, made so that the process still obeys signals."""

from __future__ import annotations

import atexit
import os
import sys
import threading
from collections.abc import Callable
from typing import Generic, NoReturn, TypeVar

T = TypeVar("T")

MOMENT_S = 1.0
"""Longer than to reach a server that is there, shorter than a person waits for a word."""


def in_background(call: Callable[[], T], waiting: Callable[[], None]) -> T:
    """The call's result, made on a thread that is left behind if a signal ends the process meanwhile.

    `waiting` is called at every moment that it takes longer. What the call raises is raised here.
    """
    attempt = _Attempt(call)
    threading.Thread(target=attempt.make, daemon=True).start()
    try:
        while not attempt.done.wait(MOMENT_S):
            waiting()
    except SystemExit as leaving:
        atexit.register(_end, leaving.code)
        raise
    return attempt.outcome()


def _end(code: str | int | None) -> NoReturn:
    """End without Python's own last steps, in which a thread that comes back from Rust would abort."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code if isinstance(code, int) else 1)


class _Attempt(Generic[T]):
    def __init__(self, call: Callable[[], T]) -> None:
        self._call = call
        self._results: list[T] = []
        self._error: BaseException | None = None
        self.done = threading.Event()

    def make(self) -> None:
        try:
            self._results.append(self._call())
        except BaseException as error:
            self._error = error
        finally:
            self.done.set()

    def outcome(self) -> T:
        if self._error:
            raise self._error
        return self._results[0]
