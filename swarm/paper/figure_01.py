"""Figure 1: the 10 x 10 arena."""

from __future__ import annotations

from swarm.gridworld.arena import OPEN_10
from swarm.paper.study import Drawing


def figure() -> Drawing:
    return Drawing("fig1", "Simulated arena", OPEN_10.grid)
