"""A recording: what a tracking system saw, moment after moment."""

from __future__ import annotations

from dataclasses import dataclass

from tracker_bridge.backends.bodies import Body
from tracker_bridge.protocols.cursor import Vector

Rows = list[list[str]]
"""The cells of a file, line by line."""


@dataclass(frozen=True)
class Moment:
    """What was seen at a time, counted from wherever the file counts."""

    t_ns: int
    bodies: list[Body]


@dataclass(frozen=True)
class Recording:
    """A whole file; positions in its own unit."""

    unit_m: float
    moments: list[Moment]


def number(row: list[str], column: int) -> float | None:
    """A cell; None where it is blank, as where a body was lost. ValueError if it is no number."""
    text = row[column].strip() if column < len(row) else ""
    return float(text) if text else None


def numbers(row: list[str], column: int, count: int) -> tuple[float, ...] | None:
    """Some cells from a column on; None if one of them is blank."""
    cells = [number(row, column + each) for each in range(count)]
    whole = tuple(each for each in cells if each is not None)
    return whole if len(whole) == count else None


def vector(row: list[str], column: int) -> Vector | None:
    """Three cells from a column on; None if one of them is blank."""
    found = numbers(row, column, 3)
    return (found[0], found[1], found[2]) if found else None
