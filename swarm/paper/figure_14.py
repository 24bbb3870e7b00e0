"""Figure 14: what became of the eight paths."""

from __future__ import annotations

from dataclasses import replace

from swarm.geometry import Move
from swarm.paper.claim import Claim, HigherRatio
from swarm.paper.conditions import GIVEN_EIGHT_PATHS, large_study
from swarm.paper.study import Shown, Study

USELESS = (Move.SW, Move.W, Move.NW, Move.N, Move.NE)


def figure() -> Study:
    title = "The R values for each path given to the agent"
    return replace(large_study("fig14", title, {"8 paths given": GIVEN_EIGHT_PATHS}), shown=Shown.RATIOS)


def claims() -> tuple[Claim, ...]:
    others = tuple(move for move in Move if move is not Move.SE)
    return (
        Claim(
            "fig14",
            "As can be seen, the path to the SE has the highest R_i value which makes it more likely to "
            "be chosen.",
            (HigherRatio(GIVEN_EIGHT_PATHS, Move.SE, others),),
        ),
        Claim(
            "fig14",
            "The paths E and S have relatively higher R_i values compared to the other 5 paths.",
            tuple(HigherRatio(GIVEN_EIGHT_PATHS, move, USELESS) for move in (Move.E, Move.S)),
        ),
    )
