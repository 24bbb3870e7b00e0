"""Checks of how much better one condition's best paths are than another's, from when and until when."""

from __future__ import annotations

from dataclasses import dataclass

from swarm.paper.claim import Better
from swarm.paper.verdicts.arrivals import arrivals_of
from swarm.paper.verdicts.curve_tests import CurveTests, compare, compare_samples, effect_between
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared, in_steps
from swarm.statistics.last_difference import Seen, first_difference, last_difference
from swarm.statistics.paired_tests import LEVEL, Window
from swarm.statistics.samples import Curves, Sample, mean_level
from swarm.statistics.sizes import below

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
    p = found.p_between(start, end) if timed else p_of_means(seen, evidence)
    verdict, why = _ruling(check, seen, p, evidence) if timed else _mean_ruling(seen, p)
    verdict, why = _sized(check, seen, (verdict, why))
    if verdict in (Verdict.DOES_NOT_HOLD, Verdict.IN_PART) and not evidence.enough_runs:
        verdict = verdict if found.family_wise.opposes else Verdict.UNDECIDED
    effect = effect_between(good, bad, start, end)
    arrivals = arrivals_of(check.better, check.worse, evidence)
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT, p, arrivals)


def p_of_means(seen: Compared, evidence: Evidence) -> float:
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
    shown = ", ".join(f"{word} {seen_in_steps(found)}" for word, found, _ in times)
    fits = all(found.agrees_with(at, check.rounded_steps) for _, found, at in times)
    return (Verdict.HOLDS if fits else Verdict.IN_PART), f"better {shown}"


def seen_in_steps(found: Seen) -> str:
    """A time with its interval."""
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
