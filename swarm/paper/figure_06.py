"""Figure 6: approach 2 to p_imitate with the beneficial path."""

from __future__ import annotations

from swarm.learning.memory import Approach
from swarm.paper.claim import Claim
from swarm.paper.conditions import BENEFICIAL, gains, one_path_study
from swarm.paper.study import Study


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
