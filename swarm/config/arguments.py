"""What a value on the command line may be: types for argparse and typer, with the ranges of the settings."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path

from swarm.config.limits import (
    FASTEST,
    LARGEST_SEED,
    LARGEST_TRIAL,
    MOST_JOBS,
    MOST_MOVES,
    MOST_PROCESSES,
    SLOWEST,
)

MAX = "max"
"""As fast as possible, in lockstep."""


def whole_number(low: int, high: int = LARGEST_SEED) -> Callable[[str], int]:
    """A whole number in a range, borders included."""
    limits = f"from {low} to {high}" if high < LARGEST_SEED else f"of at least {low}"

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text[:40]!r} is no whole number {limits}")
        return value

    return read


moves = whole_number(1, MOST_MOVES)
seed = whole_number(0, LARGEST_SEED)
processes = whole_number(0, MOST_PROCESSES)
trial = whole_number(0, LARGEST_TRIAL)
trials = whole_number(1, LARGEST_TRIAL + 1)
jobs = whole_number(1, MOST_JOBS)


def pace(text: str) -> float:
    """So many times as fast as life."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not SLOWEST <= value <= FASTEST:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no number from {SLOWEST:g} to {FASTEST:g}")
    return value


def pace_or_max(text: str) -> float | None:
    """The same, or None for `max`."""
    if text == MAX:
        return None
    try:
        return pace(text)
    except argparse.ArgumentTypeError as error:
        raise argparse.ArgumentTypeError(f"{error}, nor {MAX}") from error


def address(text: str) -> str:
    """HOST:PORT."""
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 1 <= int(port[:6]) <= 65_535:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no HOST:PORT, for instance 127.0.0.1:8765")
    return text


def place(text: str) -> Path:
    """A file or directory. A name such as `-rf` is an option that lost its way, and hard to remove."""
    path = Path(text)
    if not text or "\0" in text or text.startswith("-") or path.name.startswith("-"):
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no name for a file: it is empty or begins with -")
    return path
