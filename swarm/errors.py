"""Errors whose text is for the person at the keyboard, and the outermost frame that prints them."""

from __future__ import annotations

import difflib
import os
import sys
from collections.abc import Callable, Iterable


class UserError(Exception):
    """A bad call, file or setting: one line that says what is wrong, where, and the cure (exit code 2)."""


class RunFailedError(Exception):
    """A run that was under way and could not go on: one line that says why (exit code 1)."""


def nearest(name: str, known: Iterable[str]) -> str:
    """ "; did you mean X?" for the closest of the known names, or the list of them."""
    names = sorted(known)
    close = difflib.get_close_matches(name, names, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}"


def guarded(call: Callable[[], object]) -> int:
    """Run a command; turn its errors into one line on stderr and an exit code, never a traceback."""
    try:
        call()
    except UserError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except RunFailedError as error:
        print(f"failed: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    return 0
