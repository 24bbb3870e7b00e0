"""Waiting for what another process does: as long as it takes, since only a wrong program takes for ever."""

from __future__ import annotations

import threading
from collections.abc import Callable

LOOK_EVERY_S = 0.005


def until(condition: Callable[[], bool]) -> None:
    """Return once the condition holds."""
    while not condition():
        threading.Event().wait(LOOK_EVERY_S)
