"""The colours of skirts and of things that stand about in a simulated room."""

from __future__ import annotations

from typing import TypeAlias

from swarm.errors import UserError, nearest

Colour: TypeAlias = tuple[float, float, float]
"""Reflectance for red, green and blue light, 0..1."""

COLOURS: dict[str, Colour] = {
    "red": (0.58, 0.035, 0.03),
    "green": (0.05, 0.36, 0.07),
    "blue": (0.03, 0.08, 0.48),
    "yellow": (0.75, 0.56, 0.05),
    "orange": (0.72, 0.20, 0.03),
    "magenta": (0.55, 0.05, 0.32),
    "brown": (0.26, 0.11, 0.06),
    "white": (0.85, 0.85, 0.85),
    "black": (0.04, 0.04, 0.04),
}


def colour(name: str) -> Colour:
    """The reflectance of a named colour; UserError for a name that is not known."""
    if name not in COLOURS:
        raise UserError(f"unknown colour {name!r}; {nearest(name, COLOURS)}")
    return COLOURS[name]
