"""Out of sight for long, a demonstrator may have made a move that nobody saw: nothing is read across that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robot_agent.imitation.rests import Rest
from robot_agent.imitation.smoothing import Smoothed

LONGEST_GAP_S = 1.05
"""About half of a move."""
LONGEST_GAP_FRAMES = 3.5
"""At a low frame rate a lost frame or two are no reason yet."""


def longest_seen(smoothed: Smoothed, rests: Sequence[Rest]) -> Sequence[Rest]:
    """The rests of the longest part of a demonstration in which the demonstrator was never lost for long.

    A gap within a rest ends one part there and begins the next: the demonstrator may have gone and returned.
    """
    if not rests:
        return rests
    parts: list[list[Rest]] = [[rests[0]]]
    lost = _long_gaps(smoothed)
    for before, rest in zip([None, *rests[:-1]], rests, strict=True):
        if before and lost[before.last : rest.first].any():
            parts.append([])
        if before:
            parts[-1].append(rest)
        if lost[rest.first : rest.last].any():
            parts.append([rest])
    return max(parts, key=len)


def _long_gaps(smoothed: Smoothed) -> np.ndarray:
    """Whether the demonstrator was lost for long after each position."""
    gaps_s = np.diff(smoothed.t_s)
    return np.asarray(gaps_s > max(LONGEST_GAP_S, LONGEST_GAP_FRAMES * float(np.median(gaps_s))))
