"""Two curves under the paper's test and the family-wise one, at 5 %."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.learning.random import spawned_generator
from swarm.paper.verdicts.finding import Tested
from swarm.statistics.effect_size import EffectSize, paired_effect_size
from swarm.statistics.paired_tests import LEVEL, Window, max_t_test, pointwise_t_test, significant_windows
from swarm.statistics.samples import BoolArray, Curves, FloatArray, PairingError, Sample, mean_level

BRIDGED_POINTS = 5
"""Gaps in a window that are overlooked: 0.5m of the 20m steps of a run."""
SHORTEST_POINTS = 3
"""Shorter stretches are no window: one point in twenty is significant by chance."""


PAPER_TEST = "paired t-test at each point"
FAMILY_WISE_TEST = "max-T sign-flip test over all points"


@dataclass(frozen=True)
class CurveTests:
    """`better` against `worse`, of the same runs; a window is in favour where `better` is smaller."""

    paper: Tested
    family_wise: Tested
    times: FloatArray
    p: FloatArray
    """Of the family-wise test at each point (points,)."""
    p_in_favour: FloatArray
    """The same, 1 where the difference is against."""

    def p_between(self, start: float, end: float) -> float:
        """Of "it is never better in this time"."""
        inside = (self.times >= start) & (self.times <= end)
        return float(self.p_in_favour[inside].min(initial=1.0))


def compare(better: Curves, worse: Curves, seed: int, in_time: bool = True) -> CurveTests:
    """Both tests at every point; PairingError if the curves cannot be paired.

    If the points are not `in_time`, each stands for itself: no gap is overlooked, no stretch too short.
    """
    pointwise = pointwise_t_test(worse, better)
    rng = spawned_generator(seed, f"{better.name} {worse.name}", 0, "claims", "sign flips")
    family_wise = max_t_test(worse, better, rng)
    return CurveTests(
        _tested(PAPER_TEST, pointwise.p, pointwise.t, better.times, in_time),
        _tested(FAMILY_WISE_TEST, family_wise.p, family_wise.direction, better.times, in_time),
        better.times,
        family_wise.p,
        np.where(family_wise.direction > 0, family_wise.p, 1.0),
    )


def compare_samples(smaller: Sample, larger: Sample, seed: int) -> CurveTests:
    """Both tests of one number a run, of which `smaller` is claimed to have the smaller."""
    one, other = (
        Curves(sample.name, np.zeros(1), sample.values[:, None], sample.replicates)
        for sample in (smaller, larger)
    )
    return compare(one, other, seed, in_time=False)


def effect_between(better: Curves, worse: Curves, start: float, end: float) -> EffectSize | None:
    """How much shorter the best paths of `better` are on average between two times; None if never."""
    try:
        return paired_effect_size(
            mean_level(worse.between(start, end)), mean_level(better.between(start, end))
        )
    except PairingError:
        return None


def _tested(name: str, p: FloatArray, direction: FloatArray, times: FloatArray, in_time: bool) -> Tested:
    bridge, shortest = (BRIDGED_POINTS, min(SHORTEST_POINTS, len(times))) if in_time else (0, 1)
    found: list[tuple[Window, ...]] = []
    for sign in (1, -1):
        significant: BoolArray = (p <= LEVEL) & (direction * sign > 0)
        found.append(tuple(significant_windows(significant, times, bridge, shortest)))
    return Tested(name, float(np.min(p)), found[0], found[1], in_time)
