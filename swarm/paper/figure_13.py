"""Figure 13: an example shortest path, the one that the expert follows."""

from __future__ import annotations

from swarm.geometry import Move
from swarm.gridworld.arena import OBSTACLE_100
from swarm.paper.claim import Claim, ShortestPathMoves
from swarm.paper.study import Drawing


def figure() -> Drawing:
    path = {"shortest path": ((0, 0), OBSTACLE_100.expert_path)}
    return Drawing("fig13", "An example shortest path to the goal state", OBSTACLE_100.grid, path)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig13",
            "Any shortest path consists of a combination of 80 moves to SE, 20 moves to S and 20 moves "
            "to E directions.",
            (ShortestPathMoves(OBSTACLE_100, ((Move.SE, 80), (Move.S, 20), (Move.E, 20))),),
        ),
    )
