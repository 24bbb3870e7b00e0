"""Figure 9: approach 3 to p_imitate with a path that is not beneficial."""

from __future__ import annotations

from swarm.learning.memory import Approach
from swarm.paper.claim import Better, Claim, NoDifference
from swarm.paper.conditions import NOT_BENEFICIAL, SMALL_NO_IMITATION, losses, one_path, one_path_study
from swarm.paper.study import Study


def figure() -> Study:
    title = "Approach 3: Average Q value test, performance of the agent when a non-beneficial path is given"
    return one_path_study("fig9", title, Approach.AVERAGE_Q, NOT_BENEFICIAL)


def claims() -> tuple[Claim, ...]:
    return (
        Claim(
            "fig9",
            "A pair-wise t-test reveals that when the β value is set to 0.1, the difference between an "
            "imitation-enhanced agent and a no-imitation agent is not statistically significant.",
            (NoDifference(one_path(Approach.AVERAGE_Q, NOT_BENEFICIAL, 0.1), SMALL_NO_IMITATION),),
        ),
        Claim(
            "fig9",
            "For higher β values (0.3 and 0.5) there is a statistically significant performance loss ...",
            losses(Approach.AVERAGE_Q, NOT_BENEFICIAL, betas=(0.3, 0.5)),
        ),
        Claim(
            "fig9",
            "... but the difference is much smaller than the case with a fixed p_imitate and with the "
            "path completion test.",
            tuple(
                Better(
                    one_path(Approach.AVERAGE_Q, NOT_BENEFICIAL, beta), one_path(other, NOT_BENEFICIAL, beta)
                )
                for beta in (0.3, 0.5)
                for other in (Approach.FIXED, Approach.COMPLETION)
            ),
        ),
    )
