"""Figure 16: an agent that copies an experienced agent."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import COPYING_EXPERIENCED, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation": NO_IMITATION,
        "copying an experienced agent": COPYING_EXPERIENCED,
    }
    return large_study(
        "fig16",
        "Best path length for imitating (copying an experienced agent) and no-imitation agents",
        series,
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig16",
            "The agent that is watching an experienced (but not expert) agent has a faster learning rate "
            "compared to a no-imitation agent. A pair-wise t-test reveals that the difference between "
            "the two is statistically significant until around time step 15.5m.",
            (Better(COPYING_EXPERIENCED, NO_IMITATION, end_step=15_500_000, around_steps=2_000_000),),
        ),
    )
