"""What a snapshot's values may be once they have been a file that anybody could have changed."""

from __future__ import annotations

import math

LARGEST = 2**32 - 1
"""What a message can say of a count (uint32)."""


def count(value: object, at_most: int = LARGEST) -> int:
    """A number of things; ValueError for anything else."""
    if type(value) is not int or not 0 <= value <= at_most:
        raise ValueError(f"{value!r} is no count up to {at_most}")
    return value


def finite(value: object) -> float:
    """A number of the learning; ValueError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{value!r} is no finite number")
    return float(value)
