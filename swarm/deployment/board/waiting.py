"""Waiting for processes that are not this one's, and so tell it nothing."""

from __future__ import annotations

import time
from collections.abc import Callable

LOOK_EVERY_S = 0.1
"""How late it is seen that something has happened; a person does not notice."""


def until(condition: Callable[[], bool], within_s: float) -> bool:
    """Look again and again; False if the condition does not hold within that time."""
    deadline_s = time.monotonic() + within_s
    while not condition():
        if time.monotonic() > deadline_s:
            return False
        time.sleep(LOOK_EVERY_S)
    return True
