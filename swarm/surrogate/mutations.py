"""Ways to copy that differ in where their errors come from: the arms of section 3.5's question."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swarm.geometry import MOVES, Move
from swarm.learning.alignment import edit_distance
from swarm.surrogate.copies import CopyStore, Moves


@dataclass(frozen=True)
class TrueCopies:
    """No errors."""

    def drawn(self, true: Sequence[Move], rng: np.random.Generator) -> Moves:  # noqa: ARG002
        return tuple(true)


@dataclass(frozen=True)
class RandomEdits:
    """As many edits as a robot's copy has, but any: a move left out, added, or changed, anywhere."""

    robots: CopyStore

    def drawn(self, true: Sequence[Move], rng: np.random.Generator) -> Moves:
        copied = self.robots.drawn(true, rng)
        if not copied:
            return ()
        edited, edits = list(true), edit_distance(copied, true)
        while edit_distance(edited, true) < edits:
            _edit(edited, rng)
        return tuple(edited)


def _edit(moves: list[Move], rng: np.random.Generator) -> None:
    """One edit, which may undo another; the last move that is left is never left out."""
    kind, place = int(rng.integers(3)), int(rng.integers(len(moves)))
    if kind == 0 and len(moves) > 1:
        del moves[place]
    elif kind == 1:
        moves.insert(place, Move(int(rng.integers(MOVES))))
    else:
        moves[place] = Move((moves[place] + 1 + int(rng.integers(MOVES - 1))) % MOVES)


@dataclass(frozen=True)
class Shuffled:
    """A list that some robot copied of something else: the robots' variation without what they saw."""

    lists: tuple[Moves, ...]

    def drawn(self, true: Sequence[Move], rng: np.random.Generator) -> Moves:  # noqa: ARG002
        return self.lists[int(rng.integers(len(self.lists)))]
