"""Figure 8: approach 3 to p_imitate with the beneficial path."""

from __future__ import annotations

from swarm.experiments.claim import Claim
from swarm.experiments.paper.conditions import BENEFICIAL
from swarm.experiments.paper.shapes import gains, one_path_study
from swarm.experiments.study import Study
from swarm.learning.memory import Approach


def figure() -> Study:
    title = "Approach 3: Average Q value test, performance of the agent when a beneficial path is given"
    return one_path_study("fig8", title, Approach.AVERAGE_Q, BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig8",
            "Once again there is a clear performance increase in the learning speed of the agent when "
            "the imitated path is beneficial.",
            gains(Approach.AVERAGE_Q, BENEFICIAL),
        ),
    )
