"""Checks of how much better one condition's best paths are than another's, from when and until when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.gridworld.condition import Condition
from swarm.paper.claim import Better, CloserPairs, Joins, MuchSmallerLoss, NoDifference, negligible
from swarm.paper.verdicts.arrivals import arrivals_of
from swarm.paper.verdicts.curve_tests import CurveTests, compare, compare_samples, effect_between
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared, in_steps, named
from swarm.statistics.effect_size import paired_effect_size
from swarm.statistics.last_difference import Seen, first_difference, joining, last_difference
from swarm.statistics.paired_tests import LEVEL, Window
from swarm.statistics.samples import Curves, Sample, mean_level
from swarm.statistics.sizes import above, below, equivalent

Ruling = tuple[Verdict, str]
UNIT = "moves shorter"


@dataclass(frozen=True)
class Compared:
    """The two curves of a comparison, their tests and the time that is claimed."""

    good: Curves
    bad: Curves
    found: CurveTests
    start: float
    end: float

    @property
    def levels(self) -> tuple[Sample, Sample]:
        """The mean of each run over the time claimed, of the worse and of the better."""
        return (
            mean_level(self.bad.between(self.start, self.end)),
            mean_level(self.good.between(self.start, self.end)),
        )


def better(check: Better, evidence: Evidence) -> Finding:
    """With times: the family-wise test finds it then, and the times fit. Without: the mean is smaller."""
    good, bad = evidence.compared(check.better, check.worse, whole_run=check.whole_run)
    found = compare(good, bad, evidence.seed)
    start, end = float(check.start_step or 0), float(check.end_step or good.times[-1])
    seen = Compared(good, bad, found, start, end)
    timed = check.start_step is not None or check.end_step is not None
    p = found.p_between(start, end) if timed else _p_of_means(seen, evidence)
    verdict, why = _ruling(check, seen, p, evidence) if timed else _mean_ruling(seen, p)
    verdict, why = _sized(check, seen, (verdict, why))
    if verdict in (Verdict.DOES_NOT_HOLD, Verdict.IN_PART) and not evidence.enough_runs:
        verdict = verdict if found.family_wise.opposes else Verdict.UNDECIDED
    effect = effect_between(good, bad, start, end)
    arrivals = arrivals_of(check.better, check.worse, evidence)
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT, p, arrivals)


def _p_of_means(seen: Compared, evidence: Evidence) -> float:
    """Of sign flips, which no few runs make small."""
    worse, good = seen.levels
    return compare_samples(good, worse, evidence.seed).family_wise.smallest_p


def _mean_ruling(seen: Compared, p: float) -> Ruling:
    worse, good = seen.levels
    gains = worse.values.mean() > good.values.mean()
    if p <= LEVEL and not gains:
        return Verdict.DOES_NOT_HOLD, "worse on average"
    if p <= LEVEL:
        longer = _duration(seen.found.family_wise.against) > _duration(seen.found.family_wise.windows)
        return (Verdict.IN_PART if longer else Verdict.HOLDS), (
            "better on average, but worse for longer" if longer else "better on average"
        )
    if seen.found.family_wise.favours:
        return Verdict.IN_PART, "better at some time, but not on average"
    return Verdict.DOES_NOT_HOLD, "not significant"


def _duration(windows: tuple[Window, ...]) -> float:
    return sum(window.duration for window in windows)


def _ruling(check: Better, seen: Compared, p: float, evidence: Evidence) -> Ruling:
    last_step = float(seen.good.times[-1])
    if last_step < seen.end:
        return Verdict.UNDECIDED, f"the runs end at {in_steps(last_step)}"
    if p > LEVEL:
        opposed = seen.found.family_wise.opposes
        return Verdict.DOES_NOT_HOLD, "the opposite is significant" if opposed else "not significant"
    times = _times(check, seen, evidence)
    shown = ", ".join(f"{word} {_in_steps(found)}" for word, found, _ in times)
    fits = all(found.agrees_with(at, check.rounded_steps) for _, found, at in times)
    return (Verdict.HOLDS if fits else Verdict.IN_PART), f"better {shown}"


def _in_steps(found: Seen) -> str:
    when = "never" if found.time is None else in_steps(found.time)
    return f"{when} ({in_steps(found.low)} to {in_steps(found.high)})"


def _times(check: Better, seen: Compared, evidence: Evidence) -> list[tuple[str, Seen, float]]:
    """The times named, each with the one found."""
    times = []
    for word, search, step in (
        ("from", first_difference, check.start_step),
        ("until", last_difference, check.end_step),
    ):
        if step is not None:
            rng = evidence.generator(check.better.name, check.worse.name, word)
            times.append((word, search(seen.bad, seen.good, rng), float(step)))
    return times


def _sized(check: Better, seen: Compared, ruling: Ruling) -> Ruling:
    """A claim that also says how small the difference is."""
    if check.at_most_moves is None or ruling[0] is not Verdict.HOLDS:
        return ruling
    size = below(*seen.levels, check.at_most_moves)
    why = f"{ruling[1]}; {size.mean:.2g} moves, at most {size.bound:.2g} (claimed: {check.at_most_moves:g})"
    return (Verdict.HOLDS if size.p <= LEVEL else Verdict.IN_PART), why


def no_difference(check: NoDifference, evidence: Evidence) -> Finding:
    """Two one-sided tests: the mean difference is smaller than the margin, which few runs cannot show."""
    first, second = evidence.compared(check.first, check.second, whole_run=check.whole_run)
    found = compare(first, second, evidence.seed)
    size = equivalent(mean_level(second), mean_level(first), check.margin_moves)
    p = _p_of_means(Compared(first, second, found, 0.0, float(first.times[-1])), evidence)
    verdict, why = _same_ruling(p <= LEVEL, size.p <= LEVEL, evidence.enough_runs)
    why = f"{why}; the means differ by at most {size.bound:.2g} moves (margin {check.margin_moves:g})"
    effect = effect_between(first, second, 0, float(first.times[-1]))
    arrivals = arrivals_of(check.first, check.second, evidence)
    return Finding(
        compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT, size.p, arrivals
    )


def _same_ruling(differs: bool, same: bool, enough_runs: bool) -> Ruling:
    if same and differs:
        return Verdict.IN_PART, "the same but for a difference that is significant, and negligible"
    if same:
        return Verdict.HOLDS, "no difference is found, and none greater than the margin is possible"
    if differs:
        return Verdict.DOES_NOT_HOLD, "the means differ significantly"
    verdict = Verdict.DOES_NOT_HOLD if enough_runs else Verdict.UNDECIDED
    return verdict, "none is found, but one greater than the margin cannot be excluded"


def joins(check: Joins, evidence: Evidence) -> Finding:
    """When the curve last differs from any of the others, either way, by more than what is negligible."""
    last = max((_joined(check, other, evidence) for other in check.others), key=lambda join: join.time)
    fits = last.p <= LEVEL and last.seen.agrees_with(check.step, check.rounded_steps)
    verdict = Verdict.HOLDS if fits else Verdict.IN_PART if last.seen.time else Verdict.DOES_NOT_HOLD
    if check.step > last.found.times[-1] or (not fits and not evidence.enough_runs):
        verdict = Verdict.UNDECIDED
    margin = negligible(check.one.arena)
    why = f"it differs from {named(last.other)} by more than {margin:.2g} moves until {_in_steps(last.seen)}"
    one, other = evidence.compared(check.one, last.other)
    effect = effect_between(one, other, 0, float(check.step))
    arrivals = arrivals_of(check.one, last.other, evidence)
    return Finding(
        compared(check),
        verdict,
        why,
        last.found.paper,
        last.found.family_wise,
        effect,
        UNIT,
        last.p,
        arrivals,
    )


@dataclass(frozen=True)
class Join:
    """When a curve has joined one of the others."""

    other: Condition
    seen: Seen
    found: CurveTests
    p: float
    """Of "they do not differ before"."""

    @property
    def time(self) -> float:
        return self.seen.time or 0.0


def _joined(check: Joins, other: Condition, evidence: Evidence) -> Join:
    curves = evidence.compared(check.one, other)
    found = compare(*curves, evidence.seed)
    rng = evidence.generator(check.one.name, other.name, "joining")
    seen = joining(*curves, rng, negligible(check.one.arena))
    return Join(other, seen, found, float(found.p[found.times <= check.step].min(initial=1.0)))


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
