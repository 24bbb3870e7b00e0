"""Figure 5: approach 1 to p_imitate with a path that is not beneficial."""

from __future__ import annotations

from swarm.learning.memory import Approach
from swarm.paper.claim import Claim
from swarm.paper.conditions import NOT_BENEFICIAL, losses, one_path_study
from swarm.paper.study import Study


def figure() -> Study:
    title = "Approach 1: Fixed value, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig5", title, Approach.FIXED, NOT_BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig5",
            "A pair-wise t-test reveals that there is a statistically significant performance loss for "
            "all β values when the path given is not directing the agent towards the goal item.",
            losses(Approach.FIXED, NOT_BENEFICIAL),
        ),
    )
