"""Figure 21: copying each other beside accessing each other's Q values."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import ACCESSING_EACH_OTHER, COPYING_EACH_OTHER, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "accessing each other": ACCESSING_EACH_OTHER,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study(
        "fig21", "Best path length for copying each other and accessing each other's internal state", series
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig21",
            "As can be seen, the agent with the imitation-enhanced Q-learning algorithm learns more "
            "quickly and a pair-wise t-test reveals that the agent utilising imitation is statistically "
            "better than the other scenario between time steps 4m to 9.5m.",
            (
                Better(
                    COPYING_EACH_OTHER,
                    ACCESSING_EACH_OTHER,
                    start_step=4_000_000,
                    end_step=9_500_000,
                    around_steps=1_000_000,
                ),
            ),
        ),
    )
