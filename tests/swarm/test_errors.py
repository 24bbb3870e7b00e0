"""The outermost frame of every command: whatever happens is one line and an exit code."""

from __future__ import annotations

import errno
import subprocess
import sys

import pytest

from swarm.errors import RunFailedError, UserError, guarded, nearest
from tests.support.swarm_runs import ROOT


def raising(error: BaseException) -> int:
    """The exit code of a command that ends with this error."""

    def call() -> None:
        raise error

    return guarded(call)


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (UserError("no such robot"), 2, "error: no such robot"),
        (RunFailedError("tracker gone"), 1, "failed: tracker gone"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (
            OSError(errno.ENOSPC, "No space left on device", "log.mcap"),
            1,
            "failed: log.mcap: No space left on device; free some space, or write elsewhere",
        ),
        (PermissionError(errno.EACCES, "Permission denied", "x"), 1, "failed: x: Permission denied"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else None,
)
def test_an_error_is_one_line_and_a_code(
    capsys: pytest.CaptureFixture[str], error: BaseException, code: int, line: str
) -> None:
    assert raising(error) == code
    assert capsys.readouterr().err == f"{line}\n"


def test_an_error_that_nobody_foresaw_says_where_and_how_to_report_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SWARM_TRACEBACK", raising=False)
    assert raising(KeyError("q")) == 1
    said = capsys.readouterr().err
    assert said.startswith("failed: KeyError: 'q' (test_errors.py:")
    assert said.count("\n") == 1
    monkeypatch.setenv("SWARM_TRACEBACK", "1")
    with pytest.raises(KeyError):
        raising(KeyError("q"))


def test_a_process_that_leaves_on_a_signal_keeps_its_code() -> None:
    assert raising(SystemExit(143)) == 143
    assert raising(SystemExit()) == 0


def test_what_is_known_is_named() -> None:
    assert nearest("sirial", ["serial", "sim"]) == "did you mean 'serial'?"
    assert nearest("x", ["serial", "sim"]) == "known: serial, sim"
    assert nearest("x", []) == "there is none"


VERSION = f"{sys.executable} -m swarm --version"


@pytest.mark.parametrize(
    ("redirection", "code", "said"),
    [
        (">/dev/full", 1, "failed: No space left on device; free some space, or write elsewhere\n"),
        (">/dev/full 2>/dev/full", 1, ""),
        (">&-", 0, ""),
        ("<&- 2>&-", 0, ""),
        ("| true", 0, ""),
    ],
)
def test_output_that_cannot_be_written_ends_in_one_line_at_most(
    redirection: str, code: int, said: str
) -> None:
    done = subprocess.run(
        f"{VERSION} {redirection}", shell=True, cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (code, said)


def test_a_stream_that_was_closed_does_not_become_somebodys_file() -> None:
    """The first file opened would else be number 1, and printing would write into it."""
    program = (
        "from swarm.errors import guarded; guarded(lambda: print(open('/dev/zero').fileno() > 2 or 1/0))"
    )
    done = subprocess.run(
        f'{sys.executable} -c "{program}" >&-',
        shell=True,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
