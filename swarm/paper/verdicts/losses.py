"""Checks of one difference against another: losses, and the gaps of pairs."""

from __future__ import annotations

import numpy as np

from swarm.gridworld.condition import Condition
from swarm.paper.claim import CloserPairs, MuchSmallerLoss
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared
from swarm.statistics.effect_size import paired_effect_size
from swarm.statistics.paired_tests import LEVEL
from swarm.statistics.samples import Sample, mean_level
from swarm.statistics.sizes import above


def much_smaller_loss(check: MuchSmallerLoss, evidence: Evidence) -> Finding:
    """Twice the one loss is still smaller than the other."""
    small, large = (_loss(each, check.baseline, evidence) for each in (check.condition, check.than))
    half = Sample(f"twice {small.name}", 2 * small.values, small.replicates)
    p, smaller = above(large, half).p, above(large, small).p
    share = small.values.mean() / large.values.mean()
    why = f"{small.values.mean():.3g} against {large.values.mean():.3g} moves lost: {share:.0%}"
    verdict = Verdict.HOLDS if p <= LEVEL else Verdict.IN_PART if smaller <= LEVEL else Verdict.DOES_NOT_HOLD
    if verdict is not Verdict.HOLDS and not evidence.enough_runs:
        verdict = Verdict.UNDECIDED
    effect = paired_effect_size(large, small)
    return Finding(compared(check), verdict, why, effect=effect, effect_unit="moves less lost", p=p)


def _loss(condition: Condition, baseline: Condition, evidence: Evidence) -> Sample:
    lost, kept = map(mean_level, evidence.compared(condition, baseline, whole_run=True))
    return Sample(f"the loss of {condition.name}", lost.values - kept.values, lost.replicates)


def closer_pairs(check: CloserPairs, evidence: Evidence) -> Finding:
    """How far apart the two learners of a run are on average over the time shown."""
    apart, close = (_gap(condition, evidence) for condition in (check.than, check.condition))
    p, closer = min(1.0, 2 * above(apart, close).p), close.values.mean() < apart.values.mean()
    why = f"{close.values.mean():.3g} moves apart on average, {apart.values.mean():.3g} without copying"
    undecided = Verdict.DOES_NOT_HOLD if evidence.enough_runs else Verdict.UNDECIDED
    verdict = Verdict.HOLDS if p <= LEVEL and closer else undecided
    effect = paired_effect_size(apart, close)
    return Finding(compared(check), verdict, why, effect=effect, effect_unit="moves closer", p=p)


def _gap(condition: Condition, evidence: Evidence) -> Sample:
    one, two = (
        mean_level(evidence.results.of_learner(condition, learner).between(0, evidence.horizon_steps))
        for learner in (0, 1)
    )
    return Sample(f"the gap of {condition.name}", np.abs(one.values - two.values), one.replicates)
