"""Figure 12: an agent that is given eight paths."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import GIVEN_EIGHT_PATHS, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation": NO_IMITATION,
        "8 paths given": GIVEN_EIGHT_PATHS,
    }
    return large_study(
        "fig12",
        "Best path length for imitating (8 paths given) and no-imitation agents",
        series,
        interval_points=10,
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig12",
            "The imitation-enhanced learning agent was able to choose the beneficial paths and improve "
            "its performance. A pair-wise t-test reveals that the difference between the two is "
            "statistically significant until around time step 15.5m.",
            (Better(GIVEN_EIGHT_PATHS, NO_IMITATION, end_step=15_500_000, around_steps=2_000_000),),
        ),
    )
