"""Sets of hats that are as different as can be."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from tracker_bridge.hats.patterns import Hat, PinGrid, difference_m, every_pattern, self_difference_m

Floats = npt.NDArray[np.float64]

LEAST_SPACING_M = 0.013
"""Markers of 8 mm that stand closer run together in a tracker's cameras."""


def design_hats(
    grid: PinGrid, count: int, pins: int = 4, spacing_m: float = LEAST_SPACING_M, prefix: str = ""
) -> list[Hat]:
    """`count` hats, named by the prefix and a number from 1, whose least difference is as large as was found.

    Raises UserError if the grid does not have so many patterns.
    """
    patterns = every_pattern(grid, pins, spacing_m)
    if not len(patterns):
        raise UserError(f"no pattern of {pins} pins {1e3 * spacing_m:g} mm apart fits the grid")
    symmetric_m = self_difference_m(patterns)
    between_m = difference_m(patterns, patterns)
    chosen = _most_different(between_m, symmetric_m, count)
    if len(chosen) < count:
        raise UserError(f"the grid has {len(chosen)} patterns that differ at all; {count} were asked for")
    return [
        Hat(f"{prefix}{number}", tuple(patterns[kind])) for number, kind in enumerate(chosen[:count], start=1)
    ]


def _most_different(between_m: Floats, symmetric_m: Floats, count: int) -> list[int]:
    """The largest tolerance at which `count` patterns differ pairwise and from themselves turned (bisection
    over the differences that occur)."""
    levels = np.unique(np.round(np.concatenate([between_m.ravel(), symmetric_m]), 7))
    levels = levels[levels > 1e-6]
    low, high, best = 0, len(levels) - 1, list[int]()
    while low <= high:
        middle = (low + high) // 2
        chosen = _distinguishable(between_m, symmetric_m, float(levels[middle]))
        if len(chosen) >= count or not best:
            best = chosen
        low, high = (middle + 1, high) if len(chosen) >= count else (low, middle - 1)
    return best


def _distinguishable(between_m: Floats, symmetric_m: Floats, tolerance_m: float) -> list[int]:
    """Patterns that differ pairwise by a tolerance: always the one next that excludes the fewest others."""
    left = symmetric_m >= tolerance_m - 1e-9
    alike = between_m < tolerance_m - 1e-9
    chosen = []
    while left.any():
        excluded = np.where(left, (alike & left).sum(1), len(left) + 1)
        taken = int(excluded.argmin())
        chosen.append(taken)
        left &= ~alike[taken]
        left[taken] = False
    return chosen
