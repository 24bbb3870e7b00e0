"""Is one curve better than another, and when; or are they the same?"""

from __future__ import annotations

from swarm.analysis.windows import Window
from swarm.experiments.claim import Better, NoDifference
from swarm.experiments.judging.comparison import LEVEL, Comparison, compare, effect_between, span
from swarm.experiments.judging.evidence import Evidence
from swarm.experiments.judging.finding import Finding, Tested, Verdict
from swarm.experiments.judging.wording import compared, in_steps

Ruling = tuple[Verdict, str]
UNIT = "moves shorter"


def better(check: Better, evidence: Evidence) -> Finding:
    """The paper's test has to find the claimed window, and the honest test a part of it."""
    good, bad = evidence.tested(check.better), evidence.tested(check.worse)
    found = compare(good, bad, evidence.seed)
    last_step = float(good.times[-1])
    claimed = Window(float(check.start_step or 0), float(check.end_step or last_step))
    verdict, why = _ruling(check, found, claimed, last_step, evidence.enough_runs)
    effect = effect_between(good, bad, claimed.start, claimed.end)
    return Finding(compared(check), verdict, why, found.paper, found.honest, effect, UNIT)


def no_difference(check: NoDifference, evidence: Evidence) -> Finding:
    """The honest test must find nothing, with runs enough to find something."""
    first, second = evidence.tested(check.first), evidence.tested(check.second)
    found = compare(first, second, evidence.seed)
    verdict, why = _same_ruling(found, evidence.enough_runs)
    effect = effect_between(first, second, 0, float(first.times[-1]))
    return Finding(compared(check), verdict, why, found.paper, found.honest, effect, UNIT)


def _ruling(check: Better, found: Comparison, claimed: Window, last_step: float, enough_runs: bool) -> Ruling:
    if last_step < claimed.end:
        return Verdict.UNDECIDED, f"the runs end at {in_steps(last_step)}"
    if not found.paper.favours:
        return _not_found(found, enough_runs)
    if not any(_overlap(window, claimed) for window in found.honest.windows):
        verdict = Verdict.IN_PART if enough_runs else Verdict.UNDECIDED
        return verdict, "the paper's test finds a gain, the honest test none at the time claimed"
    missed = _missed(check, found.paper)
    if missed:
        return (Verdict.IN_PART if enough_runs else Verdict.UNDECIDED), f"better, but {missed}"
    if check.end_step is None and _longer(found.honest.against) > _longer(found.honest.windows):
        return Verdict.IN_PART, "better at first, worse for longer"
    return Verdict.HOLDS, "found by the paper's test, confirmed by the honest one"


def _not_found(found: Comparison, enough_runs: bool) -> Ruling:
    if found.honest.opposes:
        return Verdict.DOES_NOT_HOLD, "the opposite is significant"
    return (Verdict.DOES_NOT_HOLD if enough_runs else Verdict.UNDECIDED), "not significant"


def _same_ruling(found: Comparison, enough_runs: bool) -> Ruling:
    if found.honest.smallest_p <= LEVEL:
        return Verdict.DOES_NOT_HOLD, "the honest test finds a difference"
    if not enough_runs:
        return Verdict.UNDECIDED, "none was found, but so few runs would hardly show one"
    if found.paper.favours or found.paper.opposes:
        return Verdict.IN_PART, "the honest test finds none; the paper's does, at some of its many points"
    return Verdict.HOLDS, "neither test finds a difference"


def _missed(check: Better, paper: Tested) -> str:
    """Which of the claimed times the paper's own test does not reproduce; empty if none."""
    window = span(paper.windows)
    times = (("from", check.start_step, window.start), ("until", check.end_step, window.end))
    return " and ".join(
        f"{word} {in_steps(there)} instead of {in_steps(claimed)}"
        for word, claimed, there in times
        if claimed is not None and abs(there - claimed) > check.around_steps
    )


def _longer(windows: tuple[Window, ...]) -> float:
    return sum(window.duration for window in windows)


def _overlap(one: Window, other: Window) -> bool:
    return one.start <= other.end and other.start <= one.end
