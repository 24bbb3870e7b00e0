"""Checks of sameness: of means, and of curves from a time on."""

from __future__ import annotations

from dataclasses import dataclass

from swarm.gridworld.condition import Condition
from swarm.paper.claim import Joins, NoDifference, negligible
from swarm.paper.verdicts.arrivals import arrivals_of
from swarm.paper.verdicts.curve_tests import CurveTests, compare, effect_between
from swarm.paper.verdicts.differences import UNIT, Compared, Ruling, p_of_means, seen_in_steps
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared, named
from swarm.statistics.last_difference import Seen, joining
from swarm.statistics.paired_tests import LEVEL
from swarm.statistics.samples import mean_level
from swarm.statistics.sizes import equivalent


def no_difference(check: NoDifference, evidence: Evidence) -> Finding:
    """Two one-sided tests: the mean difference is smaller than the margin, which few runs cannot show."""
    first, second = evidence.compared(check.first, check.second, whole_run=check.whole_run)
    found = compare(first, second, evidence.seed)
    size = equivalent(mean_level(second), mean_level(first), check.margin_moves)
    p = p_of_means(Compared(first, second, found, 0.0, float(first.times[-1])), evidence)
    verdict, why = _same_ruling(p <= LEVEL, size.p <= LEVEL, evidence.enough_runs)
    why = f"{why}; the means differ by at most {size.bound:.2g} moves (margin {check.margin_moves:g})"
    effect = effect_between(first, second, 0, float(first.times[-1]))
    arrivals = arrivals_of(check.first, check.second, evidence)
    return Finding(
        compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT, size.p, arrivals
    )


def _same_ruling(differs: bool, same: bool, enough_runs: bool) -> Ruling:
    """A difference that is significant and negligible is none: more runs would find one anywhere."""
    if same:
        return Verdict.HOLDS, "a significant difference, but a negligible one" if differs else "none is found"
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
    until = seen_in_steps(last.seen)
    why = f"it differs from {named(last.other)} by more than {margin:.2g} moves until {until}"
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
