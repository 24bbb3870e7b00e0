"""Two conditions side by side: the paired tests, or the reason why they cannot be made."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from swarm.analysis.learning_curves import RunCurves
from swarm.statistics.effect_size import EffectSize, paired_effect_size
from swarm.statistics.paired_tests import (
    LEVEL,
    Window,
    max_t_test,
    paired_t_test,
    pointwise_t_test,
    significant_windows,
)
from swarm.statistics.samples import BoolArray, Curves, PairingError, mean_level

SIGN_FLIP_SEED = 1
"""The same logs give the same p values."""


@dataclass(frozen=True)
class Comparison:
    """`first` minus `second`, of trials with the same seed and number; a shorter path is better."""

    first: str
    second: str
    pairs: int
    moves: int
    """How far both curves reach."""
    effect: EffectSize
    """Of the mean best path length over the whole curve, in moves."""
    p: float
    """Of that difference, by a paired t-test."""
    windows: list[Window]
    """Where the paper's pointwise t-test finds a difference at 5 %."""
    family_wise_windows: list[Window]
    """Where a difference remains when all points are tested together (max-T sign flips), and with them all
    pairs of curves that are compared with each other.
    """


@dataclass(frozen=True)
class NoComparison:
    """Two conditions that no paired test can compare, and why."""

    first: str
    second: str
    reason: str


def compare_all(found: RunCurves) -> list[Comparison | NoComparison]:
    """Every two conditions."""
    return [compare(first, second) for first, second in combinations(found.curves.values(), 2)]


def compare(first: Curves, second: Curves, together: int = 1) -> Comparison | NoComparison:
    """Both are cut to the moves that they have in common first; `together` pairs share the level of the
    family-wise windows (Bonferroni).
    """
    end = min(first.times[-1], second.times[-1])
    start = max(first.times[0], second.times[0])
    one, other = first.between(start, end), second.between(start, end)
    try:
        return _compared(one, other, LEVEL / together)
    except PairingError as error:
        return NoComparison(first.name, second.name, str(error))


def _compared(one: Curves, other: Curves, level: float) -> Comparison:
    level_one, level_other = mean_level(one), mean_level(other)
    pointwise = pointwise_t_test(one, other)
    together = max_t_test(one, other, np.random.default_rng(SIGN_FLIP_SEED))
    return Comparison(
        first=one.name,
        second=other.name,
        pairs=len(one.replicates),
        moves=int(one.times[-1]),
        effect=paired_effect_size(level_one, level_other),
        p=paired_t_test(level_one, level_other).p,
        windows=_windows(pointwise.p <= LEVEL, one),
        family_wise_windows=_windows(together.p <= level, one),
    )


def _windows(significant: BoolArray, curves: Curves) -> list[Window]:
    return significant_windows(np.asarray(significant), curves.times)
