"""Waiting for what another process does: as long as it takes, since only a wrong program takes for ever."""

from __future__ import annotations

import time
from collections.abc import Callable

LOOK_EVERY_S = 0.01


def until(condition: Callable[[], bool]) -> None:
    """Return once the condition holds."""
    while not condition():
        time.sleep(LOOK_EVERY_S)
