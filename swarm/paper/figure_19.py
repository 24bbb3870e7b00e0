"""Figure 19: an agent with access to an expert's Q values."""

from __future__ import annotations

from swarm.paper.claim import Claim, FindsShortestBy, FindsShortestSooner
from swarm.paper.conditions import ACCESSING_EXPERT, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation, no access": NO_IMITATION,
        "accessing an expert": ACCESSING_EXPERT,
    }
    return large_study(
        "fig19", "Best path length for agents with and without access to an expert's internal state", series
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig19",
            "As can be seen, the learning agent becomes optimal after a very short time interval.",
            (
                FindsShortestBy(ACCESSING_EXPERT, 1_000_000),
                FindsShortestSooner(ACCESSING_EXPERT, NO_IMITATION),
            ),
        ),
    )
