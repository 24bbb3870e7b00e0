"""Figure 4: the path that is not beneficial, five moves to the east."""

from __future__ import annotations

from swarm.geometry import Grid
from swarm.paper.conditions import NOT_BENEFICIAL
from swarm.paper.study import Drawing


def figure() -> Drawing:
    path = {str(NOT_BENEFICIAL): ((0, 0), NOT_BENEFICIAL.moves)}
    return Drawing("fig4", "Non-beneficial path given to the agent", Grid(6, 6), path, marks_ends=False)
