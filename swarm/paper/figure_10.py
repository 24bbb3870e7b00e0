"""Figure 10: the 100 x 100 arena with an obstacle in the middle."""

from __future__ import annotations

from swarm.gridworld.arena import OBSTACLE_100
from swarm.paper.study import Drawing


def figure() -> Drawing:
    return Drawing("fig10", "Arena with obstacle", OBSTACLE_100.grid)
