"""Markers that belong to no hat and stay: reflections of a lamp, a lost marker."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.clock import NS_PER_S
from tracker_bridge.hats.alignment import Points

SAME_PLACE_M = 0.005
"""A reflection stands; its noise is that of a marker."""
AVERAGED = 0.1
"""Of a stray's place, of each new sighting: its own noise is then a quarter of a marker's."""
STAYS_NS = NS_PER_S
"""Older ones are named."""
FORGOTTEN_NS = NS_PER_S // 5


@dataclass
class _Stray:
    place: complex
    since_ns: int
    seen_ns: int
    named: bool = False


class StrayWatch:
    """Notices points without a hat that stay where they are."""

    def __init__(self) -> None:
        self._strays: list[_Stray] = []

    def watch(self, points: Points, t_ns: int) -> list[complex]:
        """Take the points that no hat explains; the places of strays that are now to be named, each once."""
        self._strays = [stray for stray in self._strays if t_ns - stray.seen_ns < FORGOTTEN_NS]
        for point in points:
            self._see(complex(point), t_ns)
        new = [
            stray for stray in self._strays if not stray.named and stray.seen_ns - stray.since_ns > STAYS_NS
        ]
        for stray in new:
            stray.named = True
        return [stray.place for stray in new]

    def _see(self, point: complex, t_ns: int) -> None:
        places = np.array([stray.place for stray in self._strays])
        apart_m = np.abs(places - point)
        if len(places) and apart_m.min() < SAME_PLACE_M:
            stray = self._strays[int(apart_m.argmin())]
            stray.place, stray.seen_ns = stray.place + AVERAGED * (point - stray.place), t_ns
        else:
            self._strays.append(_Stray(point, t_ns, t_ns))
