"""When best paths arrive, and when they are shortest."""

from __future__ import annotations

from dataclasses import replace

from swarm.gridworld.condition import Condition
from swarm.paper.claim import FindsShortestBy, FindsShortestSooner
from swarm.paper.verdicts.curve_tests import compare_samples
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared, in_steps
from swarm.statistics.effect_size import paired_effect_size
from swarm.statistics.paired_tests import LEVEL
from swarm.statistics.samples import Sample
from swarm.statistics.sizes import above
from swarm.statistics.survival import CensoredTimes, median_time, restricted_mean_time


def finds_shortest_sooner(check: FindsShortestSooner, evidence: Evidence) -> Finding:
    """The times of arrival, paired; a run that never arrives counts as the end of the curve.

    Counting it so makes the later of two look earlier than it is, which is against the claim.
    """
    sooner, later = _sample(check.sooner, evidence), _sample(check.later, evidence)
    found = compare_samples(sooner, later, evidence.seed)
    part = above(replace(later, values=later.values * check.part), sooner)
    medians = [_median(evidence.arrivals(condition)) for condition in (check.sooner, check.later)]
    share = sooner.values.mean() / later.values.mean()
    why = f"median {medians[0]} against {medians[1]}; {share:.0%} of the time on average"
    return Finding(
        compared(check),
        _sooner(part.p, found.family_wise.favours, evidence.enough_runs or found.family_wise.opposes),
        why,
        found.paper,
        found.family_wise,
        paired_effect_size(later, sooner),
        "steps earlier",
        part.p,
    )


def _sooner(p: float, favours: bool, decided: bool) -> Verdict:
    if favours:
        return Verdict.HOLDS if p <= LEVEL else Verdict.IN_PART
    return Verdict.DOES_NOT_HOLD if decided else Verdict.UNDECIDED


def finds_shortest_by(check: FindsShortestBy, evidence: Evidence) -> Finding:
    """The Kaplan-Meier median against the time claimed; the paper made no test."""
    arrivals = evidence.arrivals(check.condition)
    end = float(evidence.curves(check.condition).times[-1])
    mean, median = restricted_mean_time(arrivals, end), median_time(arrivals)
    why = (
        f"median {_median(arrivals)}, mean {in_steps(mean.time)} "
        f"({in_steps(mean.low)} to {in_steps(mean.high)})"
    )
    undecided = end < check.step or (not evidence.enough_runs and mean.low <= check.step <= mean.high)
    if median is not None and median <= check.step and not undecided:
        return Finding(compared(check), Verdict.HOLDS, why)
    return Finding(compared(check), Verdict.UNDECIDED if undecided else Verdict.DOES_NOT_HOLD, why)


def arrivals_of(one: Condition, other: Condition, evidence: Evidence) -> str:
    """The medians of the first arrival at all, and of the shortest path, in the curves of two conditions."""
    below_cap = one.arena.longest_path - 1.0
    first = " against ".join(_median(evidence.arrivals(each, below_cap)) for each in (one, other))
    shortest = " against ".join(_median(evidence.arrivals(each)) for each in (one, other))
    return f"first {first}; shortest {shortest}"


def _sample(condition: Condition, evidence: Evidence) -> Sample:
    replicates = evidence.curves(condition).replicates
    return Sample(condition.name, evidence.arrivals(condition).times, replicates)


def _median(arrivals: CensoredTimes) -> str:
    median = median_time(arrivals)
    return "never" if median is None else in_steps(median)
