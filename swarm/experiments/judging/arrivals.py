"""When the shortest path is found: by a time, or sooner than another finds it."""

from __future__ import annotations

from swarm.analysis.curves import Sample
from swarm.analysis.effect_size import paired_effect_size
from swarm.analysis.threshold import CensoredTimes, median_time, restricted_mean_time
from swarm.experiments.claim import FindsShortestBy, FindsShortestSooner
from swarm.experiments.judging.comparison import compare_samples
from swarm.experiments.judging.evidence import Evidence
from swarm.experiments.judging.finding import Finding, Verdict
from swarm.experiments.judging.wording import compared, in_steps
from swarm.gridworld.condition import Condition


def finds_shortest_sooner(check: FindsShortestSooner, evidence: Evidence) -> Finding:
    """The times of arrival, paired; a run that never arrives counts as the end of the curve.

    Counting it so makes the later of two look earlier than it is, which is against the claim.
    """
    sooner, later = _sample(check.sooner, evidence), _sample(check.later, evidence)
    found = compare_samples(sooner, later, evidence.seed)
    effect = paired_effect_size(later, sooner)
    medians = [_median(evidence.arrivals(condition)) for condition in (check.sooner, check.later)]
    why = f"median {medians[0]} against {medians[1]}"
    if found.honest.favours:
        verdict = Verdict.HOLDS
    else:
        decided = evidence.enough_runs or found.honest.opposes
        verdict = Verdict.DOES_NOT_HOLD if decided else Verdict.UNDECIDED
    return Finding(compared(check), verdict, why, found.paper, found.honest, effect, "steps earlier")


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


def _sample(condition: Condition, evidence: Evidence) -> Sample:
    replicates = evidence.curves(condition).replicates
    return Sample(condition.name, evidence.arrivals(condition).times, replicates)


def _median(arrivals: CensoredTimes) -> str:
    median = median_time(arrivals)
    return "never" if median is None else in_steps(median)
