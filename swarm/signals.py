"""How every command leaves when it is told to: SIGINT, SIGTERM and SIGHUP alike, with 128 + the number.

A command that has only begun to load has nothing to put in order: `leave_at_once`. One that works leaves
through every `finally`: `leave_on_signals`.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

LEAVING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

Handler = Callable[[int, FrameType | None], object]


def leave_at_once() -> None:
    """From now on a signal ends the process on the spot: an exception can be lost in what an import runs."""
    _handle(lambda number, frame: os._exit(128 + number))  # noqa: ARG005


def leave_on_signals() -> None:
    """From now on a signal ends the process in order; those that follow it change nothing."""

    def leave(number: int, frame: FrameType | None) -> None:  # noqa: ARG001
        _ignore()
        sys.exit(128 + number)

    _handle(leave)


@contextmanager
def obeying_signals() -> Iterator[None]:
    """A whole command: until it says more it leaves at once; when it is done nothing disturbs its end."""
    leave_at_once()
    try:
        yield
    finally:
        _ignore()


@contextmanager
def signals_held() -> Iterator[None]:
    """A signal that comes within the block is obeyed at its end, so that the block is done wholly.

    None comes to a thread beside the main one.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {number: signal.getsignal(number) for number in LEAVING}
    _handle(lambda number, frame: came.append(number))  # noqa: ARG005
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])


def _ignore() -> None:
    """By a handler of our own: of SIG_IGN Python complains if a signal is already on its way."""
    _handle(lambda number, frame: None)  # noqa: ARG005


def _handle(handler: Handler) -> None:
    for number in LEAVING:
        signal.signal(number, handler)
