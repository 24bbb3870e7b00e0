"""Section 2.3: agents that copy an expert, an experienced agent or each other (figures 15 to 18)."""

from __future__ import annotations

from swarm.gridworld.arena import OBSTACLE_100
from swarm.paper.claim import (
    MUCH,
    Better,
    Claim,
    CloserPairs,
    FindsShortestSooner,
    Joins,
    PortionsTested,
    visible,
)
from swarm.paper.conditions import (
    COPYING_EACH_OTHER,
    COPYING_EXPERIENCED,
    COPYING_EXPERT,
    GIVEN_EIGHT_PATHS,
    NO_IMITATION,
    NO_IMITATION_PAIR,
    large_study,
)
from swarm.paper.study import Study

VISIBLE = visible(OBSTACLE_100)


def figure_15() -> Study:
    """An agent that copies an expert."""
    series = {
        "no imitation": NO_IMITATION,
        "copying an expert": COPYING_EXPERT,
    }
    return large_study(
        "fig15",
        "Best path length for imitating (copying an expert) and no-imitation agents",
        series,
        claims=_claims_of_15(),
    )


def _claims_of_15() -> tuple[Claim, ...]:
    return (
        Claim(
            "Since each experiment consists of 100,000 simulation runs, the agent will imitate and test 1000 "
            "portions in each experiment run.",
            (PortionsTested(COPYING_EXPERT, 1000),),
        ),
        Claim(
            "As can be seen, the imitation-enhanced learning agent finds the shortest path much earlier "
            "than the agent with Q-learning only.",
            (FindsShortestSooner(COPYING_EXPERT, NO_IMITATION, MUCH),),
        ),
        Claim(
            "A pair-wise t-test reveals that the difference between the two is statistically significant "
            "until around time step 15.5m.",
            (Better(COPYING_EXPERT, NO_IMITATION, end_step=15_500_000),),
        ),
    )


def figure_16() -> Study:
    """An agent that copies an experienced agent."""
    series = {
        "no imitation": NO_IMITATION,
        "copying an experienced agent": COPYING_EXPERIENCED,
    }
    return large_study(
        "fig16",
        "Best path length for imitating (copying an experienced agent) and no-imitation agents",
        series,
        claims=_claims_of_16(),
    )


def _claims_of_16() -> tuple[Claim, ...]:
    return (
        Claim(
            "The agent that is watching an experienced (but not expert) agent has a faster learning rate "
            "compared to a no-imitation agent. A pair-wise t-test reveals that the difference between "
            "the two is statistically significant until around time step 15.5m.",
            (Better(COPYING_EXPERIENCED, NO_IMITATION, end_step=15_500_000),),
        ),
    )


def figure_17() -> Study:
    """Two agents that copy each other."""
    series = {
        "no imitation, two learners": NO_IMITATION_PAIR,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study(
        "fig17",
        "Best path length for imitating (two agents copying each other) and no-imitation agents",
        series,
        claims=_claims_of_17(),
    )


def _claims_of_17() -> tuple[Claim, ...]:
    return (
        Claim(
            "As can be seen, the imitating agents have a better performance than a no-imitation agent "
            "initially. But the difference between them vanishes after 5m time steps.",
            (Joins(COPYING_EACH_OTHER, (NO_IMITATION_PAIR,), 5_000_000),),
        ),
        Claim(
            "At the start, the one that has slightly better performance is able to improve the other but as "
            "time passes both start to converge to the same performance.",
            (CloserPairs(COPYING_EACH_OTHER, NO_IMITATION_PAIR),),
        ),
        Claim(
            "Pair-wise t-test shows that the imitating agent has a statistically better performance "
            "between the time steps 4m and 9.5m.",
            (
                Better(
                    COPYING_EACH_OTHER,
                    NO_IMITATION_PAIR,
                    start_step=4_000_000,
                    end_step=9_500_000,
                ),
            ),
        ),
        Claim(
            "Note also that some runs of the no-imitation agent converge to a shortest path earlier than "
            "the imitating agent which makes the no-imitation agent statistically better between the "
            "time steps 12.5m and 19.5m, although the difference between the two is very small.",
            (
                Better(
                    NO_IMITATION_PAIR,
                    COPYING_EACH_OTHER,
                    start_step=12_500_000,
                    end_step=19_500_000,
                    at_most_moves=VISIBLE,
                ),
            ),
        ),
    )


def figure_18() -> Study:
    """The four ways of imitating, side by side."""
    series = {
        "copying an expert": COPYING_EXPERT,
        "8 paths given": GIVEN_EIGHT_PATHS,
        "copying an experienced agent": COPYING_EXPERIENCED,
        "copying each other": COPYING_EACH_OTHER,
    }
    return large_study("fig18", "Best path length for 4 scenarios", series, claims=_claims_of_18())


def _claims_of_18() -> tuple[Claim, ...]:
    return (
        Claim(
            "As expected the agent copying an expert outperforms all others ...",
            (
                Better(COPYING_EXPERT, GIVEN_EIGHT_PATHS),
                Better(COPYING_EXPERT, COPYING_EXPERIENCED),
                Better(COPYING_EXPERT, COPYING_EACH_OTHER),
            ),
        ),
        Claim(
            "... although the agent that is given 8 paths achieves the same performance as around 5m "
            "time steps.",
            (Joins(GIVEN_EIGHT_PATHS, (COPYING_EXPERT,), 5_000_000),),
        ),
        Claim(
            "The agent that is watching an experienced (but not expert) agent achieves the same "
            "performance with these two after around 8m time steps.",
            (Joins(COPYING_EXPERIENCED, (COPYING_EXPERT, GIVEN_EIGHT_PATHS), 8_000_000),),
        ),
        Claim(
            "All three have significantly better performance than the worst case of two agents copying "
            "each other.",
            tuple(
                Better(condition, COPYING_EACH_OTHER)
                for condition in (COPYING_EXPERT, GIVEN_EIGHT_PATHS, COPYING_EXPERIENCED)
            ),
        ),
    )
