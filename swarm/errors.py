"""Errors whose text is for the person at the keyboard."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class UserError(Exception):
    """A bad call, file or setting: one line that says what is wrong, where, and the cure (exit code 2)."""


class RunFailedError(Exception):
    """A run that was under way and could not go on: one line that says why (exit code 1)."""


def nearest(name: str, known: Iterable[str]) -> str:
    """ "; did you mean X?" for the closest of the known names, or the list of them."""
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}"
