"""What sections 3.4 and 3.5 of the paper say of its robots, judged from many trials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from swarm.paper.verdicts.evidence import ENOUGH_RUNS
from swarm.paper.verdicts.finding import Verdict
from swarm.statistics.corrections import benjamini_hochberg, holm
from swarm.statistics.samples import PairingError
from swarm.surrogate.robot_tests import (
    RobotEvidence,
    RobotFinding,
    better_on_average,
    better_start_stays_ahead,
    enacted_by_ratio,
    errors_have_an_effect,
    exploits_despite_errors,
    good_start_helps_the_other,
    imperfect_among_the_most_enacted,
    larger_variation,
    least_enacted_have_the_lowest,
    most_enacted_have_the_highest,
    much_earlier,
    no_gain_without_a_good_start,
    smaller_than_with_an_expert,
    useful_paths_are_told,
)


@dataclass(frozen=True)
class RobotClaim:
    """A sentence of section 3, and its check."""

    section: str
    text: str
    check: Callable[[RobotEvidence], RobotFinding]


ROBOT_CLAIMS = (
    RobotClaim(
        "3.4.1",
        "As can be seen, the imitation-enhanced robot finds the shortest path much earlier than the robot "
        "with Q-learning only.",
        much_earlier,
    ),
    RobotClaim(
        "3.4.1",
        "During experiments, copying errors occasionally occur but the learning robot is able to exploit the "
        "information coming from the expert ...",
        exploits_despite_errors,
    ),
    RobotClaim(
        "3.4.1",
        "... as the robots are able to discriminate between useful and useless observed behaviours.",
        useful_paths_are_told,
    ),
    RobotClaim(
        "3.4.2",
        "... the imitating robots have a higher learning speed, on average, as they are able to achieve "
        "better solutions earlier than the robots with Q-learning only.",
        better_on_average,
    ),
    RobotClaim(
        "3.4.2",
        "However, as expected, the difference between the two cases is smaller compared to the previous set "
        "of experiments.",
        smaller_than_with_an_expert,
    ),
    RobotClaim(
        "3.4.2",
        "... if one of the robots makes a better start in its individual learning, by chance, then it is "
        "able to achieve better solutions sooner than the other robot.",
        better_start_stays_ahead,
    ),
    RobotClaim(
        "3.4.2",
        "As that robot improves its performance, the other robot is able to learn from it by imitation.",
        good_start_helps_the_other,
    ),
    RobotClaim(
        "3.4.2",
        "On the other hand, if none of the robots make a good start, imitation does not improve the learning "
        "speed of robots ...",
        no_gain_without_a_good_start,
    ),
    RobotClaim(
        "3.4.2",
        "The chance effect explains the larger variations in the experimental results.",
        larger_variation,
    ),
    RobotClaim(
        "3.4.2",
        "As imitating these paths improves the performance of the robot, they are more likely to be "
        "selected ...",
        enacted_by_ratio,
    ),
    RobotClaim(
        "3.4.2", "... and they have the highest R_i values (figure 27).", most_enacted_have_the_highest
    ),
    RobotClaim(
        "3.4.2",
        "These two paths have the lowest R_i values which make them less likely to be selected (figure 28).",
        least_enacted_have_the_lowest,
    ),
    RobotClaim(
        "3.5",
        "As the most enacted movement patterns were the result of imperfect imitations (in some experimental "
        "runs), ...",
        imperfect_among_the_most_enacted,
    ),
    RobotClaim(
        "3.5",
        "... it can be deduced that these errors may have a positive effect on the learning of robots.",
        errors_have_an_effect,
    ),
)
"""In the paper's order."""


@dataclass(frozen=True)
class JudgedRobotClaim:
    """A claim, what was found, and its p value among those of all claims."""

    claim: RobotClaim
    finding: RobotFinding
    holm: float | None
    benjamini_hochberg: float | None


def judge_robots(evidence: RobotEvidence) -> list[JudgedRobotClaim]:
    """Every claim of section 3."""
    findings = [_of_enough(_checked(claim, evidence), evidence) for claim in ROBOT_CLAIMS]
    p = np.array([finding.p for finding in findings if finding.p is not None], dtype=np.float64)
    corrected = iter(zip(holm(p), benjamini_hochberg(p), strict=True))
    judged = []
    for claim, finding in zip(ROBOT_CLAIMS, findings, strict=True):
        numbers = (None, None) if finding.p is None else tuple(map(float, next(corrected)))
        judged.append(JudgedRobotClaim(claim, finding, *numbers))
    return judged


def _checked(claim: RobotClaim, evidence: RobotEvidence) -> RobotFinding:
    """A test that these trials cannot make decides nothing."""
    try:
        return claim.check(evidence)
    except PairingError as error:
        return RobotFinding(Verdict.UNDECIDED, str(error), None)


def _of_enough(finding: RobotFinding, evidence: RobotEvidence) -> RobotFinding:
    """What few trials do not show may still be so."""
    trials = min(len(evidence.expert.outcomes), len(evidence.each_other.outcomes))
    if trials >= ENOUGH_RUNS or finding.verdict is not Verdict.DOES_NOT_HOLD:
        return finding
    return replace(finding, verdict=Verdict.UNDECIDED)


COLUMNS = ("section", "the paper's words", "verdict", "p", "Holm", "Benjamini-Hochberg")


def rows(judged: Sequence[JudgedRobotClaim]) -> list[tuple[str, ...]]:
    """The cells of `COLUMNS`."""
    return [
        (
            one.claim.section,
            one.claim.text,
            f"**{one.finding.verdict.value}**: {one.finding.why}",
            *("none" if p is None else f"{p:.2g}" for p in (one.finding.p, one.holm, one.benjamini_hochberg)),
        )
        for one in judged
    ]


def as_json(judged: Sequence[JudgedRobotClaim]) -> list[dict[str, Any]]:
    return [
        {
            "section": one.claim.section,
            "text": one.claim.text,
            "verdict": one.finding.verdict.value,
            "why": one.finding.why,
            "p": one.finding.p,
            "holm": one.holm,
            "benjamini_hochberg": one.benjamini_hochberg,
        }
        for one in judged
    ]
