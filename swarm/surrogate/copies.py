"""Stored pairs of true and copied lists of moves, and copies drawn from them.

The abstract engine invents no copying error: it repeats what the rendered pipeline was seen to do
(`robot-agent collect-copies` makes the store).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from swarm.errors import UserError
from swarm.files import new_csv
from swarm.geometry import MOVES, Move
from swarm.learning.alignment import aligned

STORED_COPIES = Path(__file__).parent / "data" / "best.csv"
"""Of rendered demonstrations with the profile `best`; comes with the package."""
COLUMNS = ["kind", "true", "copied"]
ENOUGH = 20
"""So many stored copies of the very same list, and others are not needed."""

Moves = tuple[Move, ...]


@dataclass(frozen=True)
class CopyPair:
    """What was shown and what was copied of it; an empty copy was refused."""

    kind: str
    true: Moves
    copied: Moves


class Copies(Protocol):
    """What a robot copies of what it is shown."""

    def drawn(self, true: Sequence[Move], rng: np.random.Generator) -> Moves:
        """The list that is remembered; empty if it copies nothing."""


@dataclass(frozen=True)
class CopyStore:
    """Pairs, all with true lists of one length."""

    pairs: tuple[CopyPair, ...]

    def drawn(self, true: Sequence[Move], rng: np.random.Generator) -> Moves:
        """What a robot would copy of this list, drawn from the pairs; empty if it copies nothing.

        If the very same list is stored often enough, one of its copies. Otherwise one of all pairs, whose
        errors are made again here: a move left out, one added, or one turned by so many eighths of a circle.
        """
        shown = tuple(true)
        same = [pair for pair in self.pairs if pair.true == shown]
        chosen = same if len(same) >= ENOUGH else [pair for pair in self.pairs if pair.kind == "random"]
        pair = chosen[int(rng.integers(len(chosen)))]
        return pair.copied if pair.true == shown else repeated_errors(pair, shown)


def repeated_errors(pair: CopyPair, shown: Moves) -> Moves:
    """The pair's errors at the same places of another list; those beyond a shorter one's end fall away."""
    if not pair.copied:
        return ()
    copied: list[Move] = []
    for place, turns in enumerate(turns_of(pair)):
        if place < len(shown):
            copied += [Move((shown[place] + turn) % MOVES) for turn in turns]
    return (*copied, *shown[len(pair.true) :])


def turns_of(pair: CopyPair) -> list[list[int]]:
    """For each true move the copied moves that stand for it, in eighths of a circle away from it.

    [0] is a true copy, [] a move left out, [0, 2] one with another added after it.
    """
    return [
        [(copied - true) % MOVES for copied in stand]
        for true, stand in zip(pair.true, aligned(pair.true, pair.copied), strict=True)
    ]


def write_copies(pairs: Iterable[CopyPair], path: Path, told: Sequence[str]) -> None:
    """A new CSV file; `told` says how it was made, in lines before the header. UserError if it is there."""
    new_csv(path, told, COLUMNS, ([pair.kind, _text(pair.true), _text(pair.copied)] for pair in pairs))


def load_copies(path: Path) -> CopyStore:
    """Read a store; UserError names the file and what is wrong with it."""
    try:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"copies {path}: {error}; make them with `robot-agent collect-copies`") from error
    rows = list(csv.reader(lines))
    if not rows or rows[0] != COLUMNS or any(len(row) != len(COLUMNS) for row in rows):
        raise UserError(f"copies {path}: each row must have {', '.join(COLUMNS)}, as in the first line")
    try:
        pairs = tuple(CopyPair(kind, _moves(true), _moves(copied)) for kind, true, copied in rows[1:])
    except KeyError as error:
        raise UserError(f"copies {path}: {error} is no compass move") from error
    return CopyStore(_checked(path, pairs))


def _checked(path: Path, pairs: tuple[CopyPair, ...]) -> tuple[CopyPair, ...]:
    lengths = {len(pair.true) for pair in pairs}
    if len(lengths) != 1 or 0 in lengths or not any(pair.kind == "random" for pair in pairs):
        raise UserError(
            f"copies {path}: needs pairs of the kind 'random', and true lists of one length; "
            "make them with `robot-agent collect-copies`"
        )
    return pairs


def _text(moves: Moves) -> str:
    return " ".join(move.name for move in moves)


def _moves(text: str) -> Moves:
    return tuple(Move[name] for name in text.split())
