"""Figure 2: the beneficial path, five moves to the south-east."""

from __future__ import annotations

from swarm.geometry import Grid
from swarm.paper.conditions import BENEFICIAL
from swarm.paper.study import Drawing


def figure() -> Drawing:
    path = {str(BENEFICIAL): ((0, 0), BENEFICIAL.moves)}
    return Drawing("fig2", "Beneficial path given to the agent", Grid(6, 6), path, marks_ends=False)
