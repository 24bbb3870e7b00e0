"""Section 2.4: agents with access to each other's Q values, beside copying (figures 19 to 21)."""

from __future__ import annotations

from swarm.gridworld.arena import OBSTACLE_100
from swarm.paper.claim import Better, Claim, FindsShortestBy, FindsShortestSooner, NoDifference, visible
from swarm.paper.conditions import (
    ACCESSING_EACH_OTHER,
    ACCESSING_EXPERT,
    COPYING_EACH_OTHER,
    NO_IMITATION,
    NO_IMITATION_PAIR,
    large_study,
)
from swarm.paper.study import Study


def figure_19() -> Study:
    """An agent with access to an expert's Q values."""
    series = {
        "no imitation, no access": NO_IMITATION,
        "accessing an expert": ACCESSING_EXPERT,
    }
    return large_study(
        "fig19",
        "Best path length for agents with and without access to an expert's internal state",
        series,
        claims=_claims_of_19(),
    )


def _claims_of_19() -> tuple[Claim, ...]:
    return (
        Claim(
            "As can be seen, the learning agent becomes optimal after a very short time interval.",
            (
                FindsShortestBy(ACCESSING_EXPERT, 1_000_000),
                FindsShortestSooner(ACCESSING_EXPERT, NO_IMITATION),
            ),
        ),
    )


def figure_20() -> Study:
    """Two agents with access to each other's Q values."""
    series = {
        "no imitation, no access, two learners": NO_IMITATION_PAIR,
        "accessing each other": ACCESSING_EACH_OTHER,
    }
    return large_study(
        "fig20",
        "Best path length for agents with and without access to each other's internal state",
        series,
        claims=_claims_of_20(),
    )


def _claims_of_20() -> tuple[Claim, ...]:
    return (
        Claim(
            "It almost has the same performance as the ε-greedy Q-learning algorithm as a pair-wise "
            "t-test reveals that there is no statistical difference between two.",
            (NoDifference(ACCESSING_EACH_OTHER, NO_IMITATION_PAIR, margin_moves=visible(OBSTACLE_100)),),
        ),
    )


def figure_21() -> Study:
    """Copying each other beside accessing each other's Q values."""
    series = {
        "accessing each other": ACCESSING_EACH_OTHER,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study(
        "fig21",
        "Best path length for copying each other and accessing each other's internal state",
        series,
        claims=_claims_of_21(),
    )


def _claims_of_21() -> tuple[Claim, ...]:
    return (
        Claim(
            "As can be seen, the agent with the imitation-enhanced Q-learning algorithm learns more "
            "quickly and a pair-wise t-test reveals that the agent utilising imitation is statistically "
            "better than the other scenario between time steps 4m to 9.5m.",
            (
                Better(
                    COPYING_EACH_OTHER,
                    ACCESSING_EACH_OTHER,
                    start_step=4_000_000,
                    end_step=9_500_000,
                ),
            ),
        ),
    )
