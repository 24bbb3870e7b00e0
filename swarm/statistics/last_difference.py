"""From when and until when two curves differ, with the intervals of these times.

The paper's "significant until" is the last time at which a paired t test finds a difference. Other runs would
have given another time: a bootstrap of the pairs says how far it moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

from swarm.statistics.averages import weighted_mean
from swarm.statistics.samples import BoolArray, Curves, FloatArray, paired_differences

IN_A_ROW = 3
"""Points: one in twenty is significant by chance, three in a row are not."""


@dataclass(frozen=True)
class Seen:
    """When a difference is first or last seen, and the 95 % interval of it; None where there never is one."""

    time: float | None
    low: float
    high: float

    def agrees_with(self, time: float, rounded_to: float) -> bool:
        """Whether another experiment of as many runs might have seen it at `time`, printed so rounded.

        That time has an error of its own, as large as this one's: the interval is wider by the root of two.
        """
        if self.time is None:
            return False
        low, high = (self.time + np.sqrt(2) * (end - self.time) for end in (self.low, self.high))
        return bool(low - rounded_to <= time <= high + rounded_to)


def last_difference(larger: Curves, smaller: Curves, rng: np.random.Generator) -> Seen:
    """The end of the last stretch in which `larger` is significantly larger; 0 in a resample without any."""
    differences = paired_differences(larger, smaller)
    return _seen(differences.values, differences.times, 0.0, rng)


def joining(one: Curves, other: Curves, rng: np.random.Generator, size: float) -> Seen:
    """The end of the last stretch in which the two differ significantly, either way, by more than `size`."""
    differences = paired_differences(one, other)
    return _seen(differences.values, differences.times, 0.0, rng, size, either=True)


def first_difference(larger: Curves, smaller: Curves, rng: np.random.Generator) -> Seen:
    """The beginning of the first such stretch; a resample without any begins at the end."""
    differences = paired_differences(larger, smaller)
    values, times = differences.values[:, ::-1], -differences.times[::-1]
    seen = _seen(values, times, -float(differences.times[-1]), rng)
    return Seen(None if seen.time is None else -seen.time, -seen.high, -seen.low)


LEVEL, RESAMPLES = 0.95, 1000
"""Of the intervals: the tails hold 25 resamples each."""


def _seen(
    values: FloatArray,
    times: FloatArray,
    never: float,
    rng: np.random.Generator,
    size: float = 0.0,
    *,
    either: bool = False,
) -> Seen:
    """The interval is the bias-corrected percentile one (Efron 1987): resamples are noisier than samples."""
    pairs = len(values)
    (seen,) = _last(np.ones((1, pairs)), values, times, size, either)
    counts = rng.multinomial(pairs, np.full(pairs, 1 / pairs), size=RESAMPLES).astype(np.float64)
    last = np.nan_to_num(_last(counts, values, times, size, either), nan=never)
    low, high = np.quantile(last, _corrected(last, float(np.nan_to_num(seen, nan=never))))
    return Seen(None if np.isnan(seen) else float(seen), float(low), float(high))


def _corrected(resampled: FloatArray, seen: float) -> FloatArray:
    """The levels of the quantiles, moved as the middle of the resamples is off what was seen."""
    before = (np.mean(resampled < seen) + np.mean(resampled <= seen)) / 2
    count = len(resampled)
    shift = special.ndtri(np.clip(before, 1 / count, 1 - 1 / count))
    ends = special.ndtri([(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    corrected: FloatArray = special.ndtr(2 * shift + ends)
    return corrected


def _last(
    weights: FloatArray, values: FloatArray, times: FloatArray, size: float, either: bool
) -> FloatArray:
    """When each resample's difference is last seen; NaN if never (resamples,)."""
    pairs = len(values)
    centre = values.mean(axis=0)
    shift = weighted_mean(weights, values - centre)
    spread = weighted_mean(weights, (values - centre) ** 2) - shift**2
    error = np.sqrt(np.clip(spread, 0, None) / (pairs - 1))
    mean = np.abs(centre + shift) if either else centre + shift
    differs: BoolArray = (mean > special.stdtrit(pairs - 1, 0.975) * error) & (mean > size)
    return _last_of(differs, times)


def _last_of(differs: BoolArray, times: FloatArray) -> FloatArray:
    row = min(IN_A_ROW, differs.shape[1])
    stretch = np.asarray(np.lib.stride_tricks.sliding_window_view(differs, row, axis=1).all(axis=2))
    last = stretch.shape[1] - 1 - stretch[:, ::-1].argmax(axis=1) + row - 1
    return np.where(stretch.any(axis=1), times[last], np.nan)
