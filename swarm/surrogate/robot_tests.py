"""The tests that decide what sections 3.4 and 3.5 of the paper say of its robots."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from swarm.learning.random import spawned_generator
from swarm.paper.claim import MUCH
from swarm.paper.verdicts.finding import Verdict
from swarm.statistics.paired_tests import LEVEL, max_t_test
from swarm.statistics.samples import BoolArray, Curves, FloatArray, Sample, mean_level
from swarm.statistics.sizes import above
from swarm.statistics.survival import times_to_threshold
from swarm.surrogate.enactment import (
    Memory,
    least_enacted,
    most_enacted,
    rank_correlations,
    share_of_imperfect,
)
from swarm.surrogate.trials import THRESHOLD, ManyTrials

START_MOVES = 1500
"""A start is good if a best path has been learnt by then that arrives."""
SAME = 0.1
""""No gain" is one of less than a tenth of the time that a robot alone takes."""


@dataclass(frozen=True)
class RobotEvidence:
    """Trials of a learner that copies an expert, and of two that copy each other; each beside a loner."""

    expert: ManyTrials
    each_other: ManyTrials

    def memories(self, many: ManyTrials) -> list[Memory]:
        found = [memory for outcome in many.outcomes for memory in outcome.memories.values()]
        return [memory for memory in found if len(memory) > 1]


@dataclass(frozen=True)
class RobotFinding:
    """What the trials say of a claim, and the p value of the test that decides."""

    verdict: Verdict
    why: str
    p: float | None


def learner_curves(many: ManyTrials, group: str, place: int = 0, *, learnt: bool = False) -> Curves:
    """The curves of one learner of a condition: two that copy each other are not a loner's equal.

    `learnt`: without the paths that arrive by luck.
    """
    name = [robot.id for robot in many.experiment.learners if robot.group == group][place]
    curves = many.curves[group]
    kinds = [outcome.learnt_paths if learnt else outcome.best_paths for outcome in many.outcomes]
    rows = [paths[name][: len(curves.times)] for paths in kinds]
    return replace(curves, name=name, values=np.array(rows, dtype=np.float64))


def groups(many: ManyTrials) -> tuple[str, str]:
    """The condition that imitates, and the one that does not."""
    imitating = next(robot.group for robot in many.experiment.learners if robot.watches)
    alone = next(robot.group for robot in many.experiment.learners if not robot.watches)
    return imitating, alone


def imitators_and_loners(many: ManyTrials) -> tuple[Curves, Curves]:
    """The first learner of each."""
    imitating, alone = groups(many)
    return learner_curves(many, imitating), learner_curves(many, alone)


def decided(p: float, why: str, *, favourable: bool = True) -> RobotFinding:
    holds = p <= LEVEL and favourable
    return RobotFinding(Verdict.HOLDS if holds else Verdict.DOES_NOT_HOLD, why, p)


def much_earlier(evidence: RobotEvidence) -> RobotFinding:
    """Half of the time to the first shortest path; one that is never found counts as the end."""
    sooner, later = (_arrivals(curves) for curves in imitators_and_loners(evidence.expert))
    part = above(replace(later, values=MUCH * later.values), sooner)
    why = f"shortest path at move {sooner.values.mean():,.0f} against {later.values.mean():,.0f} on average"
    return decided(part.p, why)


def exploits_despite_errors(evidence: RobotEvidence) -> RobotFinding:
    """The mean best path over the trial is shorter, with copies of which some are wrong."""
    copies = [copied for outcome in evidence.expert.outcomes for copied in outcome.copies]
    wrong = float(np.mean([not copied.perfect for copied in copies]))
    p, gain = _gain_test(evidence.expert)
    why = f"{wrong:.0%} of the copies are wrong; {gain:.1f} moves shorter on average"
    if not wrong:
        return RobotFinding(Verdict.UNDECIDED, f"{why}: no copying error occurred", p)
    return decided(p, why, favourable=gain > 0)


def better_on_average(evidence: RobotEvidence) -> RobotFinding:
    p, gain = _gain_test(evidence.each_other)
    return decided(p, f"{gain:.1f} moves shorter on average over the trial", favourable=gain > 0)


def smaller_than_with_an_expert(evidence: RobotEvidence) -> RobotFinding:
    """Of two experiments, so not paired: Welch's test."""
    expert, other = _gains(evidence.expert), _gains(evidence.each_other)
    p = float(stats.ttest_ind(expert, other, equal_var=False, alternative="greater").pvalue)
    return decided(p, f"a gain of {other.mean():.1f} moves, {expert.mean():.1f} with an expert")


def better_start_stays_ahead(evidence: RobotEvidence) -> RobotFinding:
    """Of two that copy each other, does the one with the better first moves come to good paths sooner?"""
    one, two = _pair(evidence)
    start = mean_level(one.between(0, START_MOVES)).values - mean_level(two.between(0, START_MOVES)).values
    later = _lasting(one) - _lasting(two)
    told = (start != 0) & (later != 0)
    same = int(np.sum(np.sign(start[told]) == np.sign(later[told])))
    p = float(stats.binomtest(same, max(1, int(told.sum())), 0.5, alternative="greater").pvalue)
    return decided(p, f"in {same} of the {int(told.sum())} trials in which the starts differ")


def good_start_helps_the_other(evidence: RobotEvidence) -> RobotFinding:
    """Robots with a bad start of their own: with a partner that had a good one, against those alone."""
    helped, _, alone = _bad_starts(evidence)
    if _cannot_be_compared(helped, alone):
        return RobotFinding(Verdict.UNDECIDED, "too few trials", None)
    p = float(stats.ttest_ind(helped, alone, equal_var=False, alternative="less").pvalue)
    why = (
        f"after a bad start, good paths from move {helped.mean():,.0f} on with a partner that had a good one"
    )
    return decided(p, f"{why} ({len(helped)} robots), {alone.mean():,.0f} alone ({len(alone)})")


def no_gain_without_a_good_start(evidence: RobotEvidence) -> RobotFinding:
    """The same with a partner whose start was as bad: equivalent to being alone, but for a tenth."""
    _, unhelped, alone = _bad_starts(evidence)
    if _cannot_be_compared(unhelped, alone):
        return RobotFinding(Verdict.UNDECIDED, "too few trials", None)
    margin = SAME * alone.mean()
    tests = (
        stats.ttest_ind(unhelped + margin, alone, equal_var=False, alternative="greater"),
        stats.ttest_ind(unhelped - margin, alone, equal_var=False, alternative="less"),
    )
    gain = float(stats.ttest_ind(unhelped, alone, equal_var=False, alternative="less").pvalue)
    p = max(float(test.pvalue) for test in tests)
    why = (
        f"good paths from move {unhelped.mean():,.0f} on ({len(unhelped)} robots), {alone.mean():,.0f} alone"
    )
    if p > LEVEL and gain > LEVEL:
        return RobotFinding(Verdict.UNDECIDED, f"{why}: neither a gain nor its absence is shown", p)
    return decided(p, why)


def larger_variation(evidence: RobotEvidence) -> RobotFinding:
    """The spread of the robots that copy each other against that of those that copy an expert."""
    expert, other = (mean_level(imitators_and_loners(many)[0]).values for many in _both(evidence))
    p = float(stats.levene(other, expert, center="median").pvalue)
    why = f"s.d. of the mean best path {other.std(ddof=1):.1f}, with an expert {expert.std(ddof=1):.1f} moves"
    return decided(p, why, favourable=other.std() > expert.std())


def enacted_by_ratio(evidence: RobotEvidence) -> RobotFinding:
    """Spearman's correlation of R and the number of enactments, in each memory."""
    found = [rank_correlations(evidence.memories(many), "enacted") for many in _both(evidence)]
    p = max(_above_zero(each) for each in found)
    return decided(
        p, f"mean rank correlation {found[0].mean():.2f} with an expert, {found[1].mean():.2f} in pairs"
    )


def most_enacted_have_the_highest(evidence: RobotEvidence) -> RobotFinding:
    """R of the most enacted path against the mean of its memory."""
    memories = evidence.memories(evidence.each_other)
    above_mean = np.array([most_enacted(memory).ratio - _mean_ratio(memory) for memory in memories])
    return decided(_above_zero(above_mean), f"{above_mean.mean():+.2f} against the mean R of its memory")


def least_enacted_have_the_lowest(evidence: RobotEvidence) -> RobotFinding:
    """R of the least enacted path against the mean of its memory."""
    memories = evidence.memories(evidence.each_other)
    below_mean = np.array([_mean_ratio(memory) - least_enacted(memory).ratio for memory in memories])
    return decided(_above_zero(below_mean), f"{-below_mean.mean():+.2f} against the mean R of its memory")


def useful_paths_are_told(evidence: RobotEvidence) -> RobotFinding:
    """Spearman's correlation of R and of how far a path leads to the south-east, in each memory."""
    found = rank_correlations(evidence.memories(evidence.each_other), "usefulness")
    return decided(_above_zero(found), f"mean rank correlation {found.mean():.2f} of R and use")


def imperfect_among_the_most_enacted(evidence: RobotEvidence) -> RobotFinding:
    """Whether there are such trials; how many are to be expected of copies that make no difference."""
    memories = [memory for many in _both(evidence) for memory in evidence.memories(many)]
    if not memories:
        return RobotFinding(Verdict.UNDECIDED, "no memory holds two paths", None)
    seen = float(np.mean([not most_enacted(memory).path.perfect for memory in memories]))
    base = float(np.mean([not path.path.perfect for memory in memories for path in memory]))
    why = f"in {seen:.0%} of {len(memories)} memories; {base:.0%} of all copies are imperfect"
    return RobotFinding(Verdict.HOLDS if seen else Verdict.DOES_NOT_HOLD, why, None)


def errors_have_an_effect(evidence: RobotEvidence) -> RobotFinding:
    """Imperfect copies are enacted more than their share of the memories that hold both kinds."""
    memories = [memory for many in _both(evidence) for memory in evidence.memories(many)]
    rng = spawned_generator(evidence.expert.experiment.run.seed, "embodiment", 0, "claims", "permutations")
    share = share_of_imperfect(memories, rng)
    if share is None:
        return RobotFinding(Verdict.UNDECIDED, "no memory holds true and imperfect copies", None)
    return decided(share.p, f"{share.enacted:.1%} of the enactments, {share.expected:.1%} of the paths")


def _both(evidence: RobotEvidence) -> tuple[ManyTrials, ManyTrials]:
    return evidence.expert, evidence.each_other


def _pair(evidence: RobotEvidence) -> tuple[Curves, Curves]:
    imitating, _ = groups(evidence.each_other)
    return (
        learner_curves(evidence.each_other, imitating, 0),
        learner_curves(evidence.each_other, imitating, 1),
    )


def _arrivals(curves: Curves) -> Sample:
    assert curves.scale is not None
    times = times_to_threshold(curves, curves.scale.lowest).times
    return Sample(curves.name, times, curves.replicates)


def _lasting(curves: Curves) -> FloatArray:
    """From which move on each robot's best path has no more than 12 moves; the end if never."""
    return times_to_threshold(curves, THRESHOLD, lasting=True).times


def _gains(many: ManyTrials) -> FloatArray:
    imitating, alone = imitators_and_loners(many)
    gains: FloatArray = mean_level(alone).values - mean_level(imitating).values
    return gains


def _gain_test(many: ManyTrials) -> tuple[float, float]:
    """The p value of sign flips, and the mean gain."""
    imitating, alone = (
        replace(curves, times=np.zeros(1), values=mean_level(curves).values[:, None])
        for curves in imitators_and_loners(many)
    )
    rng = spawned_generator(many.experiment.run.seed, many.experiment.run.name, 0, "claims", "sign flips")
    return max_t_test(alone, imitating, rng).smallest_p, float(_gains(many).mean())


def _cannot_be_compared(one: FloatArray, other: FloatArray) -> bool:
    """Too few, or nobody came to good paths at all."""
    return min(len(one), len(other)) < 2 or np.ptp(one) == 0 or np.ptp(other) == 0


def _bad_starts(evidence: RobotEvidence) -> tuple[FloatArray, FloatArray, FloatArray]:
    """When robots with a bad start come to good paths: partner's start good, partner's bad, and alone."""
    pair, (imitating, _) = _pair(evidence), groups(evidence.each_other)
    good = [_arrived(learner_curves(evidence.each_other, imitating, place, learnt=True)) for place in (0, 1)]
    helped, unhelped, alone = [], [], []
    for curves, own, partners in ((pair[0], good[0], good[1]), (pair[1], good[1], good[0])):
        times = _lasting(curves)
        helped.append(times[~own & partners])
        unhelped.append(times[~own & ~partners])
    for many in _both(evidence):
        _, loners = groups(many)
        bad = ~_arrived(learner_curves(many, loners, learnt=True))
        alone.append(_lasting(learner_curves(many, loners))[bad])
    return np.concatenate(helped), np.concatenate(unhelped), np.concatenate(alone)


def _arrived(curves: Curves) -> BoolArray:
    """Whether each robot has learnt a path that arrives by the end of its start."""
    assert curves.scale is not None
    arrived: BoolArray = np.asarray(
        (curves.between(0, START_MOVES).values < curves.scale.highest).any(axis=1)
    )
    return arrived


def _above_zero(values: FloatArray) -> float:
    return float(stats.ttest_1samp(values, 0.0, alternative="greater").pvalue) if len(values) > 1 else 1.0


def _mean_ratio(memory: Memory) -> float:
    return float(np.mean([path.ratio for path in memory]))
