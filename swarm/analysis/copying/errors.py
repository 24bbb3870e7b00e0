"""Copying errors: of which kind they are, and which moves differ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from swarm.learning.alignment import edit_distance


class ErrorKind(StrEnum):
    """How a copied list of moves differs from the real one."""

    PERFECT = "perfect"
    EXTRA = "one move extra"
    LOST = "one move lost"
    HEADING = "one heading wrong"
    SEVERAL = "several errors"


@dataclass(frozen=True)
class Differences:
    """Places of moves that have no equal in the other list, in one of the shortest explanations."""

    copied: frozenset[int]
    real: frozenset[int]


def error_kind(copied: Sequence[int], real: Sequence[int]) -> ErrorKind:
    """The kind of a copy's error."""
    distance = edit_distance(copied, real)
    if distance == 0:
        return ErrorKind.PERFECT
    if distance > 1:
        return ErrorKind.SEVERAL
    by_length = {1: ErrorKind.EXTRA, -1: ErrorKind.LOST, 0: ErrorKind.HEADING}
    return by_length[len(copied) - len(real)]


def differences(copied: Sequence[int], real: Sequence[int]) -> Differences:
    """Which moves an explanation with the fewest errors calls extra, lost or wrong (the last of equals)."""
    in_copy, in_real = set(range(len(copied))), set(range(len(real)))
    place, other = len(copied), len(real)
    while place and other:
        distance = edit_distance(copied[:place], real[:other])
        if distance == edit_distance(copied[: place - 1], real[:other]) + 1:
            place -= 1
        elif distance == edit_distance(copied[:place], real[: other - 1]) + 1:
            other -= 1
        else:
            place, other = place - 1, other - 1
            if copied[place] == real[other]:
                in_copy.discard(place)
                in_real.discard(other)
    return Differences(frozenset(in_copy), frozenset(in_real))


def contains(moves: Sequence[int], part: Sequence[int]) -> bool:
    """Whether `part` occurs in `moves` without a gap."""
    return any(list(moves[at : at + len(part)]) == list(part) for at in range(len(moves) - len(part) + 1))
