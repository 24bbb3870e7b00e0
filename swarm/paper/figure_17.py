"""Figure 17: two agents that copy each other."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import COPYING_EACH_OTHER, NO_IMITATION, large_study
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "no imitation": NO_IMITATION,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study(
        "fig17",
        "Best path length for imitating (two agents copying each other) and no-imitation agents",
        series,
    )


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig17",
            "As can be seen, the imitating agents have a better performance than a no-imitation agent "
            "initially. But the difference between them vanishes after 5m time steps.",
            (Better(COPYING_EACH_OTHER, NO_IMITATION, end_step=5_000_000, around_steps=1_000_000),),
        ),
        Claim(
            "fig17",
            "Pair-wise t-test shows that the imitating agent has a statistically better performance "
            "between the time steps 4m and 9.5m.",
            (
                Better(
                    COPYING_EACH_OTHER,
                    NO_IMITATION,
                    start_step=4_000_000,
                    end_step=9_500_000,
                    around_steps=1_000_000,
                ),
            ),
        ),
        Claim(
            "fig17",
            "Note also that some runs of the no-imitation agent converge to a shortest path earlier than "
            "the imitating agent which makes the no-imitation agent statistically better between the "
            "time steps 12.5m and 19.5m, although the difference between the two is very small.",
            (
                Better(
                    NO_IMITATION,
                    COPYING_EACH_OTHER,
                    start_step=12_500_000,
                    end_step=19_500_000,
                    around_steps=1_000_000,
                ),
            ),
        ),
    )
