"""The checks that a claim's comparisons ask for: differences, arrivals, ratios, shortest paths."""

from __future__ import annotations

import numpy as np

from swarm.geometry import Move
from swarm.gridworld.arena import Arena, distances, neighbours
from swarm.gridworld.condition import Condition, GivenPaths
from swarm.paper.claim import (
    Better,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    NoDifference,
    ShortestPathMoves,
)
from swarm.paper.verdicts.curve_tests import LEVEL, CurveTests, compare, compare_samples, effect_between, span
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Tested, Verdict
from swarm.paper.verdicts.wording import compared, in_steps
from swarm.statistics.effect_size import paired_effect_size
from swarm.statistics.paired_tests import Window
from swarm.statistics.samples import Curves, FloatArray, Sample
from swarm.statistics.survival import CensoredTimes, median_time, restricted_mean_time


def finds_shortest_sooner(check: FindsShortestSooner, evidence: Evidence) -> Finding:
    """The times of arrival, paired; a run that never arrives counts as the end of the curve.

    Counting it so makes the later of two look earlier than it is, which is against the claim.
    """
    sooner, later = _sample(check.sooner, evidence), _sample(check.later, evidence)
    found = compare_samples(sooner, later, evidence.seed)
    effect = paired_effect_size(later, sooner)
    medians = [_median(evidence.arrivals(condition)) for condition in (check.sooner, check.later)]
    why = f"median {medians[0]} against {medians[1]}"
    if found.family_wise.favours:
        verdict = Verdict.HOLDS
    else:
        decided = evidence.enough_runs or found.family_wise.opposes
        verdict = Verdict.DOES_NOT_HOLD if decided else Verdict.UNDECIDED
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, "steps earlier")


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


Ruling = tuple[Verdict, str]
UNIT = "moves shorter"


def better(check: Better, evidence: Evidence) -> Finding:
    """The paper's test has to find the claimed window, and the family-wise test a part of it."""
    good, bad = evidence.tested(check.better), evidence.tested(check.worse)
    found = compare(good, bad, evidence.seed)
    last_step = float(good.times[-1])
    claimed = Window(float(check.start_step or 0), float(check.end_step or last_step))
    verdict, why = _ruling(check, found, claimed, last_step, evidence.enough_runs)
    effect = effect_between(good, bad, claimed.start, claimed.end)
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT)


def no_difference(check: NoDifference, evidence: Evidence) -> Finding:
    """The family-wise test must find nothing, with runs enough to find something."""
    first, second = evidence.tested(check.first), evidence.tested(check.second)
    found = compare(first, second, evidence.seed)
    verdict, why = _same_ruling(found, evidence.enough_runs)
    effect = effect_between(first, second, 0, float(first.times[-1]))
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, UNIT)


def _ruling(check: Better, found: CurveTests, claimed: Window, last_step: float, enough_runs: bool) -> Ruling:
    if last_step < claimed.end:
        return Verdict.UNDECIDED, f"the runs end at {in_steps(last_step)}"
    if not found.paper.favours:
        return _not_found(found, enough_runs)
    if not any(_overlap(window, claimed) for window in found.family_wise.windows):
        verdict = Verdict.IN_PART if enough_runs else Verdict.UNDECIDED
        return verdict, "the paper's test finds a gain, the family-wise test none at the time claimed"
    missed = _missed(check, found.paper)
    if missed:
        return (Verdict.IN_PART if enough_runs else Verdict.UNDECIDED), f"better, but {missed}"
    if check.end_step is None and _longer(found.family_wise.against) > _longer(found.family_wise.windows):
        return Verdict.IN_PART, "better at first, worse for longer"
    return Verdict.HOLDS, "found by the paper's test, confirmed by the family-wise one"


def _not_found(found: CurveTests, enough_runs: bool) -> Ruling:
    if found.family_wise.opposes:
        return Verdict.DOES_NOT_HOLD, "the opposite is significant"
    return (Verdict.DOES_NOT_HOLD if enough_runs else Verdict.UNDECIDED), "not significant"


def _same_ruling(found: CurveTests, enough_runs: bool) -> Ruling:
    if found.family_wise.smallest_p <= LEVEL:
        return Verdict.DOES_NOT_HOLD, "the family-wise test finds a difference"
    if not enough_runs:
        return Verdict.UNDECIDED, "none was found, but so few runs would hardly show one"
    if found.paper.favours or found.paper.opposes:
        return (
            Verdict.IN_PART,
            "the family-wise test finds none; the paper's does, at some of its many points",
        )
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


def higher_ratio(check: HigherRatio, evidence: Evidence) -> Finding:
    """One path against each of the others, in one family: a "point" of the tests for each other path."""
    higher, lower = _pairs(check, evidence)
    found = compare(lower, higher, evidence.seed, in_time=False)
    beaten = round(sum(window.duration + 1 for window in found.family_wise.windows))
    others = len(check.lower)
    why = (
        f"R of {check.higher.name} {higher.values.mean():.3f}, of the others at most "
        f"{lower.values.mean(axis=0).max():.3f}; significantly above {beaten} of {others}"
    )
    effect = effect_between(lower, higher, 0, others)
    verdict = _verdict(beaten, others, evidence.enough_runs or found.family_wise.smallest_p <= LEVEL)
    return Finding(compared(check), verdict, why, found.paper, found.family_wise, effect, "higher")


def _verdict(beaten: int, others: int, decided: bool) -> Verdict:
    if beaten == others:
        return Verdict.HOLDS
    if not decided:
        return Verdict.UNDECIDED
    return Verdict.IN_PART if beaten else Verdict.DOES_NOT_HOLD


def _pairs(check: HigherRatio, evidence: Evidence) -> tuple[Curves, Curves]:
    assert isinstance(check.condition.teacher, GivenPaths)
    first_moves = [path.moves[0] for path in check.condition.teacher.paths]
    ratios = evidence.results.ratios(check.condition)
    lower = ratios[:, [first_moves.index(move) for move in check.lower]]
    higher = np.repeat(ratios[:, [first_moves.index(check.higher)]], len(check.lower), axis=1)
    return _curves(check.higher.name, higher), _curves("the other paths", lower)


def _curves(name: str, values: FloatArray) -> Curves:
    return Curves(name, np.arange(float(values.shape[1])), values, tuple(range(len(values))))


def shortest_path_moves(check: ShortestPathMoves) -> Finding:
    """The claimed counts against the fewest and most moves in each direction of all shortest paths.

    It holds in part if a shortest path has, but for one move in each direction, the claimed counts.
    """
    ranges = {move: move_range(check.arena, move) for move in Move}
    claimed = dict(check.moves)
    right = [ranges[move] == (claimed.get(move, 0),) * 2 for move in Move]
    shown = ", ".join(f"{_in_words(ranges[move])} {move.name}" for move in Move if ranges[move][1])
    length = distances(check.arena)[check.arena.grid.start]
    why = f"a shortest path has {length} moves: {shown}"
    if all(right):
        return Finding(compared(check), Verdict.HOLDS, why)
    near = all(low - 1 <= claimed.get(move, 0) <= high + 1 for move, (low, high) in ranges.items())
    return Finding(compared(check), Verdict.IN_PART if near else Verdict.DOES_NOT_HOLD, why)


def move_range(arena: Arena, move: Move) -> tuple[int, int]:
    """The fewest and the most moves in one direction that a shortest path can have."""
    to_go, table = distances(arena), neighbours(arena)
    ranges: dict[int, tuple[int, int]] = {arena.grid.goal: (0, 0)}
    states = sorted((state for state in range(arena.grid.states) if to_go[state] > 0), key=to_go.item)
    for state in states:
        onward = [
            (step, ranges[int(entered)])
            for step, entered in enumerate(table[state])
            if to_go[entered] == to_go[state] - 1
        ]
        fewest = min(low + (step == move) for step, (low, _) in onward)
        ranges[state] = fewest, max(high + (step == move) for step, (_, high) in onward)
    return ranges[arena.grid.start]


def _in_words(counts: tuple[int, int]) -> str:
    return str(counts[0]) if counts[0] == counts[1] else f"{counts[0]} to {counts[1]}"
