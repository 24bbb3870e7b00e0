"""Figure 11: the eight paths given to the agent."""

from __future__ import annotations

from swarm.geometry import Grid
from swarm.paper.conditions import EIGHT_PATHS
from swarm.paper.study import Drawing


def figure() -> Drawing:
    paths = {path.moves[0].name: ((20, 20), path.moves) for path in EIGHT_PATHS}
    return Drawing("fig11", "8 paths given to the agent", Grid(41, 41), paths, marks_ends=False)
