"""Figure 3: approach 1 to p_imitate with the beneficial path."""

from __future__ import annotations

from swarm.learning.memory import Approach
from swarm.paper.claim import Claim, FindsShortestSooner
from swarm.paper.conditions import BENEFICIAL, BETAS, SMALL_NO_IMITATION, gains, one_path, one_path_study
from swarm.paper.study import Study


def figure() -> Study:
    title = "Approach 1: Fixed value, performance of the agent when a beneficial path is given"
    return one_path_study("fig3", title, Approach.FIXED, BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig3",
            "As can be expected, there is a performance increase in the learning speed of the agent "
            "compared to a no-imitation agent.",
            gains(Approach.FIXED, BENEFICIAL),
        ),
        Claim(
            "fig3",
            "The imitation-enhanced agent finds the shortest path much earlier than the agent with "
            "Q-learning only.",
            tuple(
                FindsShortestSooner(one_path(Approach.FIXED, BENEFICIAL, beta), SMALL_NO_IMITATION)
                for beta in BETAS
            ),
        ),
    )
