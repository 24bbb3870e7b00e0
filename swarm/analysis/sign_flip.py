"""The honest test of a whole curve: a max-T sign-flip permutation test of the paired differences.

If a pair's two members are exchangeable, the sign of each replicate's whole difference curve is a
coin toss. The largest |t| over the curve is compared with its distribution under such tosses, so the
chance to call *any* point different when none is, is at most the level (Westfall and Young's
single-step maxT, family-wise error over all points).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.analysis.curves import Curves, FloatArray
from swarm.analysis.pairing import paired_differences, refuse_zero_variance

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
