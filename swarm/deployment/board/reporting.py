"""What the machine answers while it works, and the one kind of error that it tells."""

from __future__ import annotations

import json
import subprocess
from contextlib import suppress
from pathlib import Path


class BoardError(Exception):
    """One line for the person who deploys."""


def run(words: list[str]) -> str:
    """What a program prints; BoardError with its last line if it fails."""
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    except OSError as error:
        raise BoardError(f"{words[0]}: {error.strerror}") from error
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise BoardError(
            f"{Path(words[0]).name} failed: {lines[-1] if lines else f'exit code {done.returncode}'}"
        )
    return done.stdout


def step(text: str) -> None:
    say("step", text)


def say(kind: str, content: object) -> None:
    """Whoever asked may be gone; what has been begun is done all the same."""
    with suppress(OSError):
        print(json.dumps({kind: content}), flush=True)
