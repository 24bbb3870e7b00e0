"""A way, split where it bends: again and again at the farthest place from a chord.

Ramer (1972); Douglas and Peucker (1973).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robot_agent.imitation.trajectory import Floats


def split(first: int, last: int, bend_between: Callable[[int, int], int | None]) -> list[int]:
    """The ends of the parts of a way: first, last, and every bend between two places that is told."""
    ends, waiting = [first], [last]
    while waiting:
        bend = bend_between(ends[-1], waiting[-1])
        if bend is None:
            ends.append(waiting.pop())
        else:
            waiting.append(bend)
    return ends


def from_chord(xy_m: Floats, start_m: Floats, end_m: Floats) -> Floats:
    """The shortest vectors [N, 2] from a chord to places [N, 2]."""
    chord_m = end_m - start_m
    square_m2 = float(chord_m @ chord_m)
    along = np.clip((xy_m - start_m) @ chord_m / square_m2, 0.0, 1.0) if square_m2 else np.zeros(len(xy_m))
    away: Floats = xy_m - start_m - along[:, None] * chord_m
    return away
