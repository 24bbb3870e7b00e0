"""Figure 5: approach 1 to p_imitate with a path that is not beneficial."""

from __future__ import annotations

from swarm.experiments.claim import Claim
from swarm.experiments.paper.conditions import NOT_BENEFICIAL
from swarm.experiments.paper.shapes import losses, one_path_study
from swarm.experiments.study import Study
from swarm.learning.memory import Approach


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
