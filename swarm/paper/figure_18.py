"""Figure 18: the four ways of imitating, side by side."""

from __future__ import annotations

from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import (
    COPYING_EACH_OTHER,
    COPYING_EXPERIENCED,
    COPYING_EXPERT,
    GIVEN_EIGHT_PATHS,
    large_study,
)
from swarm.paper.study import Study


def figure() -> Study:
    series = {
        "copying an expert": COPYING_EXPERT,
        "8 paths given": GIVEN_EIGHT_PATHS,
        "copying an experienced agent": COPYING_EXPERIENCED,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study("fig18", "Best path length for 4 scenarios", series)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig18",
            "As expected the agent copying an expert outperforms all others ...",
            (
                Better(COPYING_EXPERT, GIVEN_EIGHT_PATHS),
                Better(COPYING_EXPERT, COPYING_EXPERIENCED),
                Better(COPYING_EXPERT, COPYING_EACH_OTHER),
            ),
        ),
        Claim(
            "fig18",
            "... although the agent that is given 8 paths achieves the same performance as around 5m "
            "time steps.",
            (Better(COPYING_EXPERT, GIVEN_EIGHT_PATHS, end_step=5_000_000, around_steps=1_500_000),),
        ),
        Claim(
            "fig18",
            "The agent that is watching an experienced (but not expert) agent achieves the same "
            "performance with these two after around 8m time steps.",
            (
                Better(COPYING_EXPERT, COPYING_EXPERIENCED, end_step=8_000_000, around_steps=1_500_000),
                Better(GIVEN_EIGHT_PATHS, COPYING_EXPERIENCED, end_step=8_000_000, around_steps=1_500_000),
            ),
        ),
        Claim(
            "fig18",
            "All three have significantly better performance than the worst case of two agents copying "
            "each other.",
            tuple(
                Better(condition, COPYING_EACH_OTHER)
                for condition in (COPYING_EXPERT, GIVEN_EIGHT_PATHS, COPYING_EXPERIENCED)
            ),
        ),
    )
