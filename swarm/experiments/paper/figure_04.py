"""Figure 4: the path that is not beneficial, five moves to the east."""

from __future__ import annotations

from swarm.experiments.paper.conditions import NOT_BENEFICIAL
from swarm.experiments.study import Drawing
from swarm.geometry import Grid


def figure() -> Drawing:
    path = {str(NOT_BENEFICIAL): ((0, 0), NOT_BENEFICIAL.moves)}
    return Drawing("fig4", "Non-beneficial path given to the agent", Grid(6, 6), path, marks_ends=False)
