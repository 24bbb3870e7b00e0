"""Section 2.2: how to choose p_imitate, with one path in memory on the 10 x 10 arena (figures 1 to 9)."""

from __future__ import annotations

from swarm.geometry import Grid
from swarm.gridworld.arena import OPEN_10
from swarm.learning.memory import Approach
from swarm.paper.claim import (
    MUCH,
    Better,
    Claim,
    Converged,
    FindsShortestSooner,
    MuchSmallerLoss,
    NoDifference,
    negligible,
    visible,
)
from swarm.paper.conditions import (
    BENEFICIAL,
    BETAS,
    NOT_BENEFICIAL,
    SMALL_NO_IMITATION,
    gains,
    losses,
    one_path,
    one_path_study,
)
from swarm.paper.study import Drawing, Study


def figure_1() -> Drawing:
    """The 10 x 10 arena."""
    return Drawing("fig1", "Simulated arena", OPEN_10.grid)


def figure_2() -> Drawing:
    """The beneficial path, five moves to the south-east."""
    path = {str(BENEFICIAL): ((0, 0), BENEFICIAL.moves)}
    return Drawing("fig2", "Beneficial path given to the agent", Grid(6, 6), path, marks_ends=False)


def figure_3() -> Study:
    """Approach 1 to p_imitate with the beneficial path."""
    title = "Approach 1: Fixed value, performance of the agent when a beneficial path is given"
    return one_path_study("fig3", title, Approach.FIXED, BENEFICIAL, claims=_claims_of_3())


CONVERGED = 0.01
"""1 % of the reward, the largest of all Q values."""


def _claims_of_3() -> tuple[Claim, ...]:
    return (
        Claim(
            "In one experiment run, the agent gets to the goal state 100,000 times and so the Q values for "
            "each state-action pair have adequate time to converge to their final values.",
            (Converged(SMALL_NO_IMITATION, CONVERGED),),
        ),
        Claim(
            "As can be expected, there is a performance increase in the learning speed of the agent "
            "compared to a no-imitation agent.",
            gains(Approach.FIXED, BENEFICIAL),
        ),
        Claim(
            "The imitation-enhanced agent finds the shortest path much earlier than the agent with "
            "Q-learning only.",
            tuple(
                FindsShortestSooner(one_path(Approach.FIXED, BENEFICIAL, beta), SMALL_NO_IMITATION, MUCH)
                for beta in BETAS
            ),
        ),
    )


def figure_4() -> Drawing:
    """The path that is not beneficial, five moves to the east."""
    path = {str(NOT_BENEFICIAL): ((0, 0), NOT_BENEFICIAL.moves)}
    return Drawing("fig4", "Non-beneficial path given to the agent", Grid(6, 6), path, marks_ends=False)


def figure_5() -> Study:
    """Approach 1 to p_imitate with a path that is not beneficial."""
    title = "Approach 1: Fixed value, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig5", title, Approach.FIXED, NOT_BENEFICIAL, claims=_claims_of_5())


def _claims_of_5() -> tuple[Claim, ...]:
    return (
        Claim(
            "A pair-wise t-test reveals that there is a statistically significant performance loss for "
            "all β values when the path given is not directing the agent towards the goal item.",
            losses(Approach.FIXED, NOT_BENEFICIAL),
        ),
    )


def figure_6() -> Study:
    """Approach 2 to p_imitate with the beneficial path."""
    title = "Approach 2: Path completion test, performance of the agent when a beneficial path is given"
    return one_path_study("fig6", title, Approach.COMPLETION, BENEFICIAL, claims=_claims_of_6())


def _claims_of_6() -> tuple[Claim, ...]:
    return (
        Claim(
            "Once again there is a clear performance increase in the learning speed of the agent when "
            "the imitated path is beneficial.",
            gains(Approach.COMPLETION, BENEFICIAL),
        ),
    )


def figure_7() -> Study:
    """Approach 2 to p_imitate with a path that is not beneficial."""
    title = "Approach 2: Path completion test, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig7", title, Approach.COMPLETION, NOT_BENEFICIAL, claims=_claims_of_7())


def _claims_of_7() -> tuple[Claim, ...]:
    return (
        Claim(
            "Although it is slightly better than the case with a fixed p_imitate, ...",
            tuple(
                Better(
                    one_path(Approach.COMPLETION, NOT_BENEFICIAL, beta),
                    one_path(Approach.FIXED, NOT_BENEFICIAL, beta),
                    at_most_moves=visible(OPEN_10),
                    whole_run=True,
                )
                for beta in BETAS
            ),
        ),
        Claim(
            "... there is still a statistically significant performance loss for all β values when the "
            "path given is not beneficial.",
            losses(Approach.COMPLETION, NOT_BENEFICIAL),
        ),
    )


def figure_8() -> Study:
    """Approach 3 to p_imitate with the beneficial path."""
    title = "Approach 3: Average Q value test, performance of the agent when a beneficial path is given"
    return one_path_study("fig8", title, Approach.AVERAGE_Q, BENEFICIAL, claims=_claims_of_8())


def _claims_of_8() -> tuple[Claim, ...]:
    return (
        Claim(
            "Once again there is a clear performance increase in the learning speed of the agent when "
            "the imitated path is beneficial.",
            gains(Approach.AVERAGE_Q, BENEFICIAL),
        ),
    )


def figure_9() -> Study:
    """Approach 3 to p_imitate with a path that is not beneficial."""
    title = "Approach 3: Average Q value test, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig9", title, Approach.AVERAGE_Q, NOT_BENEFICIAL, claims=_claims_of_9())


def _claims_of_9() -> tuple[Claim, ...]:
    return (
        Claim(
            "As can be seen, the performance loss due to imitating a non-beneficial path is minimal compared "
            "to the previous two tries.",
            tuple(
                MuchSmallerLoss(
                    one_path(Approach.AVERAGE_Q, NOT_BENEFICIAL, 0.1),
                    one_path(other, NOT_BENEFICIAL, 0.1),
                    SMALL_NO_IMITATION,
                )
                for other in (Approach.FIXED, Approach.COMPLETION)
            ),
        ),
        Claim(
            "A pair-wise t-test reveals that when the β value is set to 0.1, the difference between an "
            "imitation-enhanced agent and a no-imitation agent is not statistically significant.",
            (
                NoDifference(
                    one_path(Approach.AVERAGE_Q, NOT_BENEFICIAL, 0.1),
                    SMALL_NO_IMITATION,
                    margin_moves=negligible(OPEN_10),
                    whole_run=True,
                ),
            ),
        ),
        Claim(
            "For higher β values (0.3 and 0.5) there is a statistically significant performance loss ...",
            losses(Approach.AVERAGE_Q, NOT_BENEFICIAL, betas=(0.3, 0.5)),
        ),
        Claim(
            "... but the difference is much smaller than the case with a fixed p_imitate and with the "
            "path completion test.",
            tuple(
                MuchSmallerLoss(
                    one_path(Approach.AVERAGE_Q, NOT_BENEFICIAL, beta),
                    one_path(other, NOT_BENEFICIAL, beta),
                    SMALL_NO_IMITATION,
                )
                for beta in (0.3, 0.5)
                for other in (Approach.FIXED, Approach.COMPLETION)
            ),
        ),
    )
