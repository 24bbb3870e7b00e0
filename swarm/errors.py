"""Errors whose text is for the person at the keyboard, and the outermost frame that prints them."""

from __future__ import annotations

import difflib
import errno
import os
import sys
import traceback
from collections.abc import Callable, Iterable
from io import TextIOWrapper

TRACEBACK = "SWARM_TRACEBACK"
"""An error that nobody foresaw is one line too; with this variable set it keeps its traceback."""


class UserError(Exception):
    """A bad call, file or setting: one line that says what is wrong, where, and the cure (exit code 2)."""


class RunFailedError(Exception):
    """A run that was under way and could not go on: one line that says why (exit code 1)."""


def nearest(name: str, known: Iterable[str]) -> str:
    """ "; did you mean X?" for the closest of the known names, or the list of them."""
    names = sorted(known)
    if not names:
        return "there is none"
    close = difflib.get_close_matches(name, names, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}"


def one_line(text: str, at_most: int = 1000) -> str:
    """Text that a terminal shows as one line: what cannot be printed as escapes, and an end to it."""
    printable = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)
    return printable if len(printable) <= at_most else f"{printable[:at_most]}..."


def guarded(call: Callable[[], object]) -> int:
    """Run a command; turn its errors into one line on stderr and an exit code, never a traceback.

    0: done. 1: it was under way and could not go on. 2: a bad call, file or setting. 130: interrupted.
    """
    _mend_streams()
    return _flushed(_code_of(call))


def _code_of(call: Callable[[], object]) -> int:
    try:
        call()
    except SystemExit as leave:
        return leave.code if isinstance(leave.code, int) else 0
    except UserError as error:
        return _said(f"error: {error}", 2)
    except RunFailedError as error:
        return _said(f"failed: {error}", 1)
    except KeyboardInterrupt:
        return _said("interrupted", 130)
    except BrokenPipeError:
        return BROKEN_PIPE
    except OSError as error:
        return _said(f"failed: {in_words(error)}", 1)
    except Exception as error:
        if os.environ.get(TRACEBACK):
            raise
        return _said(f"failed: {_unforeseen(error)}", 1)
    return 0


BROKEN_PIPE = 141
"""As a shell counts a program that SIGPIPE ended: 128 + 13."""


def in_words(error: OSError) -> str:
    """Which file, what is wrong, and, if the disk is full, the cure."""
    where = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, str | bytes) else ""
    cure = "; free some space, or write elsewhere" if error.errno in NO_ROOM else ""
    return f"{where}{error.strerror or error}{cure}"


NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""A full disk, a full quota, a file as large as it may become."""


def _unforeseen(error: Exception) -> str:
    """An error that nobody foresaw, with its place in the source."""
    places = traceback.extract_tb(error.__traceback__)
    at = f" ({os.path.basename(places[-1].filename)}:{places[-1].lineno})" if places else ""
    text = one_line(str(error), 200)
    return (
        f"{type(error).__name__}: {text}{at}; this is a mistake of the program: "
        f"set {TRACEBACK}=1, repeat the command, and report what it prints"
    )


def _said(line: str, code: int) -> int:
    """Print a line where errors go; there may be nowhere."""
    try:
        print(one_line(line), file=sys.stderr, flush=True)
    except OSError:
        _to_nowhere(2)
    return code


def _flushed(code: int) -> int:
    """Everything printed, or the reason why not: else Python would complain only while it leaves."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        _to_nowhere(1)
        return BROKEN_PIPE
    except OSError as error:
        _to_nowhere(1)
        return _said(f"failed: the result cannot be printed ({in_words(error)})", code or 1)
    return code


def _mend_streams() -> None:
    """Standard streams that the caller closed lead nowhere: else the next file opened would take their place.

    What is no UTF-8, such as the name of a file, is printed with escapes.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        if getattr(sys, name) is None:
            _to_nowhere(number)
            setattr(sys, name, os.fdopen(number, mode, closefd=False))
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _to_nowhere(number: int) -> None:
    null = os.open(os.devnull, os.O_RDWR)
    if null != number:
        os.dup2(null, number)
        os.close(null)
    os.set_inheritable(number, True)
