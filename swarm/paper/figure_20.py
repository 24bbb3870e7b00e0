"""Figure 20: two agents with access to each other's Q values."""

from __future__ import annotations

from swarm.paper.claim import Claim, NoDifference
from swarm.paper.conditions import ACCESSING_EACH_OTHER, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation, no access": NO_IMITATION,
        "accessing each other": ACCESSING_EACH_OTHER,
    }
    return large_study(
        "fig20", "Best path length for agents with and without access to each other's internal state", series
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig20",
            "It almost has the same performance as the ε-greedy Q-learning algorithm as a pair-wise "
            "t-test reveals that there is no statistical difference between two.",
            (NoDifference(ACCESSING_EACH_OTHER, NO_IMITATION),),
        ),
    )
