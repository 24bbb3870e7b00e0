"""How large a paired difference is: whether it is above or below a size, or within a margin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

from swarm.statistics.samples import Sample, paired_differences, refuse_zero_variance


@dataclass(frozen=True)
class SizeTest:
    """A one-sided t test about a mean paired difference; `bound` is the limit that 95 % of samples keep."""

    mean: float
    bound: float
    p: float


def above(first: Sample, second: Sample, size: float = 0.0) -> SizeTest:
    """Is the mean of `first` minus `second` greater than `size`?"""
    mean, error, pairs = _mean_and_error(first, second)
    bound = mean - float(special.stdtrit(pairs - 1, 0.95)) * error
    return SizeTest(mean, bound, float(special.stdtr(pairs - 1, (size - mean) / error)))


def below(first: Sample, second: Sample, size: float) -> SizeTest:
    """Is the mean of `first` minus `second` smaller than `size`?"""
    opposite = above(second, first, -size)
    return SizeTest(-opposite.mean, -opposite.bound, opposite.p)


def equivalent(first: Sample, second: Sample, margin: float) -> SizeTest:
    """Are the two the same but for `margin` (two one-sided tests, Schuirmann 1987)?

    `bound` is the greatest distance that the 90 % interval of the difference allows.
    """
    not_more, not_less = below(first, second, margin), above(first, second, -margin)
    bound = max(not_more.bound, -not_less.bound)
    return SizeTest(not_more.mean, bound, max(not_more.p, not_less.p))


def _mean_and_error(first: Sample, second: Sample) -> tuple[float, float, int]:
    differences = paired_differences(first, second)
    refuse_zero_variance(differences.name, differences.values)
    pairs = len(differences.values)
    return float(differences.values.mean()), float(differences.values.std(ddof=1) / np.sqrt(pairs)), pairs
