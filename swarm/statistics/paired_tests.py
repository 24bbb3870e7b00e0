"""The paper's paired t-test, the family-wise test of a whole curve, and the windows that they find."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

from swarm.statistics.samples import (
    BoolArray,
    Curves,
    FloatArray,
    Sample,
    paired_differences,
    refuse_zero_variance,
)


@dataclass(frozen=True)
class TTest:
    """Student's t of the paired differences, its two-sided p value and its degrees of freedom."""

    t: float
    p: float
    degrees_of_freedom: int


@dataclass(frozen=True)
class PointwiseTest:
    """t and two-sided p at each point (points,); where no pair differs, t is 0 and p is 1."""

    t: FloatArray
    p: FloatArray


def paired_t_test(first: Sample, second: Sample) -> TTest:
    """Is the mean of `first` minus `second` 0? PairingError if that cannot be asked of these samples."""
    differences = paired_differences(first, second)
    refuse_zero_variance(differences.name, differences.values)
    test = _t_of(differences.values[:, None])
    return TTest(float(test.t[0]), float(test.p[0]), len(differences.values) - 1)


def pointwise_t_test(first: Curves, second: Curves) -> PointwiseTest:
    """The paired t-test at every point of two curves, each on its own, as the paper does it.

    Where all pairs differ by the same amount other than 0, t is infinite and p is 0, as scipy has it.
    PairingError if they do so everywhere.
    """
    differences = paired_differences(first, second)
    refuse_zero_variance(differences.name, differences.values.ravel())
    return _t_of(differences.values)


def _t_of(differences: FloatArray) -> PointwiseTest:
    mean = differences.mean(axis=0)
    error = differences.std(axis=0, ddof=1) / np.sqrt(len(differences))
    constant = np.all(differences == differences[0], axis=0)
    t = np.where(mean == 0, 0.0, np.copysign(np.inf, mean))
    np.divide(mean, error, out=t, where=~constant)
    return PointwiseTest(t, 2 * special.stdtr(len(differences) - 1, -np.abs(t)))


_CHUNK = 500


@dataclass(frozen=True)
class MaxTTest:
    """`direction` (points,) is the sign of the mean difference; `p` (points,) is adjusted for all points."""

    direction: FloatArray
    p: FloatArray
    permutations: int
    exact: bool

    @property
    def smallest_p(self) -> float:
        """The p value of "there is no difference anywhere"."""
        return float(self.p.min())


def max_t_test(
    first: Curves, second: Curves, rng: np.random.Generator, permutations: int = 10_000
) -> MaxTTest:
    """Where does `first` differ from `second`? All tosses are tried when there are no more than asked for.

    Flipping signs keeps every point's sum of squares, and with it t is the same increasing function of
    |sum| / sqrt(n * sum of squares) at every point; so this ratio is compared instead of t, and a
    difference without variance is no special case.
    """
    differences = paired_differences(first, second)
    refuse_zero_variance(differences.name, differences.values.ravel())
    scaled = _unit_columns(differences.values)
    seen = np.abs(scaled.sum(axis=0))
    exact = 2 ** (len(scaled) - 1) <= permutations
    largest = np.concatenate(
        [np.abs(signs @ scaled).max(axis=1) for signs in _tosses(len(scaled), permutations, rng)]
    )
    p = _share_at_least(seen, np.sort(largest), counted_itself=exact)
    return MaxTTest(np.sign(scaled.sum(axis=0)), p, len(largest), exact)


def _unit_columns(differences: FloatArray) -> FloatArray:
    length = np.sqrt((differences**2).sum(axis=0))
    scaled: FloatArray = np.divide(differences, length, out=np.zeros_like(differences), where=length > 0)
    return scaled


def _tosses(replicates: int, permutations: int, rng: np.random.Generator) -> list[FloatArray]:
    """Rows of +1 and -1; the first sign stays +1, since flipping all of them changes no |t|."""
    if 2 ** (replicates - 1) <= permutations:
        bits = np.arange(2 ** (replicates - 1))[:, None] >> np.arange(replicates)[None, :] & 1
        signs: FloatArray = 1.0 - 2.0 * bits[:, ::-1].astype(np.float64)
    else:
        signs = 1.0 - 2.0 * rng.integers(2, size=(permutations, replicates)).astype(np.float64)
    return [signs[start : start + _CHUNK] for start in range(0, len(signs), _CHUNK)]


def _share_at_least(seen: FloatArray, ascending: FloatArray, counted_itself: bool) -> FloatArray:
    """The share of tosses whose largest ratio is at least the one seen; a rounding error counts as equal."""
    at_least = len(ascending) - np.searchsorted(ascending, seen - 1e-9 * np.abs(seen), side="left")
    itself = 0 if counted_itself else 1
    share: FloatArray = (at_least + itself) / (len(ascending) + itself)
    return share


@dataclass(frozen=True)
class Window:
    """A stretch of time, both ends included."""

    start: float
    end: float

    @property
    def duration(self) -> float:
        return self.end - self.start


def significant_windows(
    significant: BoolArray, times: FloatArray, bridge: int = 0, shortest: int = 1
) -> list[Window]:
    """The stretches of significant points.

    Gaps of up to `bridge` points inside a stretch are overlooked; then stretches of fewer than
    `shortest` points are left out. The defaults overlook nothing.
    """
    places = np.flatnonzero(significant)
    if not len(places):
        return []
    stretches = np.split(places, np.flatnonzero(np.diff(places) > bridge + 1) + 1)
    return [
        Window(float(times[stretch[0]]), float(times[stretch[-1]]))
        for stretch in stretches
        if stretch[-1] - stretch[0] + 1 >= shortest
    ]
