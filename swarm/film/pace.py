"""When each picture of a film is of: evenly in the run's time, but slower while the robot watches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from swarm.clock import NS_PER_S

VISIT_S = 4.0
"""Of film for a visit: its thirty seconds would else be over in one or two pictures."""
MOST_OF_FILM = 0.5
"""Visits take no more of it; then each takes less."""

Span = tuple[int, int]
"""From when to when, in ns of the run."""


@dataclass(frozen=True)
class Pace:
    """The run's time of each picture, and how many times as fast as life it goes by there."""

    times_ns: Sequence[int]
    speeds: Sequence[float]


def pace(span: Span, visits: Sequence[Span], seconds: float, pictures: int) -> Pace:
    """`visits` are apart from each other, in order, and inside the span."""
    share = min(MOST_OF_FILM, len(visits) * VISIT_S / seconds) if visits else 0.0
    watching_ns = sum(end - begin for begin, end in visits)
    others_ns = span[1] - span[0] - watching_ns
    if not watching_ns or not others_ns or share <= watching_ns / (span[1] - span[0]):
        visits, share, others_ns = (), 0.0, span[1] - span[0]
    borders = [span[0], *(border for visit in visits for border in visit), span[1]]
    # Of the run's time in a film of length 1: beside visits, and in them.
    rates = [others_ns / (1 - share), watching_ns / share if share else 0.0]
    lengths = [(end - begin) / rates[place % 2] for place, (begin, end) in enumerate(pairwise(borders))]
    reached = np.concatenate([[0.0], np.cumsum(lengths)])
    shown = np.linspace(0.0, reached[-1], pictures)
    times_ns = np.interp(shown, reached, borders)
    stretch = np.clip(np.searchsorted(reached, shown, side="right") - 1, 0, len(lengths) - 1)
    return Pace(
        [round(t_ns) for t_ns in times_ns],
        [rates[int(place) % 2] / seconds / NS_PER_S for place in stretch],
    )
