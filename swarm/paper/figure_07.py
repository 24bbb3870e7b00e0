"""Figure 7: approach 2 to p_imitate with a path that is not beneficial."""

from __future__ import annotations

from swarm.learning.memory import Approach
from swarm.paper.claim import Better, Claim
from swarm.paper.conditions import BETAS, NOT_BENEFICIAL, losses, one_path, one_path_study
from swarm.paper.study import Study


def figure() -> Study:
    title = "Approach 2: Path completion test, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig7", title, Approach.COMPLETION, NOT_BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig7",
            "Although it is slightly better than the case with a fixed p_imitate, ...",
            tuple(
                Better(
                    one_path(Approach.COMPLETION, NOT_BENEFICIAL, beta),
                    one_path(Approach.FIXED, NOT_BENEFICIAL, beta),
                )
                for beta in BETAS
            ),
        ),
        Claim(
            "fig7",
            "... there is still a statistically significant performance loss for all β values when the "
            "path given is not beneficial.",
            losses(Approach.COMPLETION, NOT_BENEFICIAL),
        ),
    )
