"""The times at which two curves differ, as the paper reports them: "between the time steps 4m and 9.5m"."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.analysis.curves import BoolArray, FloatArray


@dataclass(frozen=True)
class Window:
    """A stretch of time, both ends included."""

    start: float
    end: float

    @property
    def duration(self) -> float:
        return self.end - self.start


def significant_windows(
    significant: BoolArray, times: FloatArray, bridge: int = 0, shortest: int = 1
) -> list[Window]:
    """The stretches of significant points.

    Gaps of up to `bridge` points inside a stretch are overlooked; then stretches of fewer than
    `shortest` points are left out. The defaults overlook nothing.
    """
    places = np.flatnonzero(significant)
    if not len(places):
        return []
    stretches = np.split(places, np.flatnonzero(np.diff(places) > bridge + 1) + 1)
    return [
        Window(float(times[stretch[0]]), float(times[stretch[-1]]))
        for stretch in stretches
        if stretch[-1] - stretch[0] + 1 >= shortest
    ]
