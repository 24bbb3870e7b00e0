"""Figure 15: an agent that copies an expert."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim, FindsShortestSooner
from swarm.paper.conditions import COPYING_EXPERT, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation": NO_IMITATION,
        "copying an expert": COPYING_EXPERT,
    }
    return large_study(
        "fig15", "Best path length for imitating (copying an expert) and no-imitation agents", series
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig15",
            "As can be seen, the imitation-enhanced learning agent finds the shortest path much earlier "
            "than the agent with Q-learning only.",
            (FindsShortestSooner(COPYING_EXPERT, NO_IMITATION),),
        ),
        Claim(
            "fig15",
            "A pair-wise t-test reveals that the difference between the two is statistically significant "
            "until around time step 15.5m.",
            (Better(COPYING_EXPERT, NO_IMITATION, end_step=15_500_000, around_steps=2_000_000),),
        ),
    )
