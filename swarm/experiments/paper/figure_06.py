"""Figure 6: approach 2 to p_imitate with the beneficial path."""

from __future__ import annotations

from swarm.experiments.claim import Claim
from swarm.experiments.paper.conditions import BENEFICIAL
from swarm.experiments.paper.shapes import gains, one_path_study
from swarm.experiments.study import Study
from swarm.learning.memory import Approach


def figure() -> Study:
    title = "Approach 2: Path completion test, performance of the agent when a beneficial path is given"
    return one_path_study("fig6", title, Approach.COMPLETION, BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig6",
            "Once again there is a clear performance increase in the learning speed of the agent when "
            "the imitated path is beneficial.",
            gains(Approach.COMPLETION, BENEFICIAL),
        ),
    )
