"""95 % bands around the mean of replicates: at each point on its own, and over the whole curve.

Values with a scale, such as best path lengths between the shortest path and the cap, are often all at one end
of it; Student's t has no width there. So the sample is taken together with a quarter of a replicate at each
end, and its t interval is made on the logit's axis, where no limit leaves the scale. How often the intervals
hold the truth is in docs/decisions/intervals.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

from swarm.errors import UserError
from swarm.statistics.averages import average, weighted_mean
from swarm.statistics.samples import Curves, FloatArray, Scale


@dataclass(frozen=True)
class Band:
    """A curve with the limits around it, each (points,)."""

    centre: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def errors(self) -> FloatArray:
        """How far the limits are below and above the curve (2, points)."""
        return np.array([self.centre - self.low, self.high - self.centre])


@dataclass(frozen=True)
class Ends:
    """What a replicate might have come to at each point besides what those at hand did."""

    scale: Scale
    latest: FloatArray
    """The longest that a value may still be (points,)."""


def ends_of(curves: Curves) -> Ends | None:
    """None for curves without a scale.

    Learning goes down, at a pace that may be half of the slowest at hand: at any time a replicate may still
    be where the slowest was at half of it.
    """
    if curves.scale is None:
        return None
    slowest = np.concatenate([[curves.scale.highest], curves.values.max(axis=0)])
    at_half = slowest[np.searchsorted(curves.times, curves.times / 2, side="right")]
    return Ends(curves.scale, np.maximum(at_half, slowest[1:]))


FEWEST = 4
"""Of fewer replicates no interval is given: how often it holds the truth was measured of 4 and more."""


def interval(curves: Curves) -> Band | None:
    """The mean of curves with its 95 % interval at each point; None of fewer than `FEWEST` replicates."""
    return pointwise_t_band(curves.values, ends_of(curves)) if len(curves.values) >= FEWEST else None


def sample_interval(values: FloatArray, scale: Scale) -> Band:
    """The mean of numbers (replicates, points) that know no time, with its 95 % interval."""
    return pointwise_t_band(values, Ends(scale, np.full(values.shape[1], scale.highest)))


def pointwise_t_band(values: FloatArray, ends: Ends | None = None, level: float = 0.95) -> Band:
    """Student's t interval of the mean at each point of `values` (replicates, points)."""
    _need_two(values)
    if ends is None:
        mean, half = (
            average(values),
            special.stdtrit(len(values) - 1, 0.5 + level / 2) * standard_error(values),
        )
        return Band(mean, mean - half, mean + half)
    extended = _extended(values, ends)
    return _logit_band(values, extended, ends.scale, special.stdtrit(len(values) + 1, 0.5 + level / 2))


def simultaneous_band(
    values: FloatArray,
    rng: np.random.Generator,
    ends: Ends | None = None,
    level: float = 0.95,
    resamples: int = 2000,
) -> Band:
    """The bootstrap max-T band of the mean curve.

    Without a scale the critical value is the quantile, over resamples, of the largest studentised distance
    max_t |mean*(t) - mean(t)| / se*(t), each resample with its own standard error. With one it is that of the
    distance on the logit's axis over the sample's own error, as much larger as Student's t is than the normal
    quantile: a resample of few capped replicates has no error that could be divided by.
    """
    _need_two(values)
    chunks = _resampled(len(values), values.shape[1], resamples, rng)
    if ends is None:
        error, mean = standard_error(values), average(values)
        half = np.quantile(np.concatenate([_largest_t(each, values) for each in chunks]), level) * error
        return Band(mean, mean - half, mean + half)
    extended = _extended(values, ends)
    farthest = np.concatenate([_farthest(each, extended, ends.scale) for each in chunks])
    student = special.stdtrit(len(values) + 1, 0.5 + level / 2)
    critical = np.quantile(farthest, level) * student / special.ndtri(0.5 + level / 2)
    return _logit_band(values, extended, ends.scale, max(float(critical), student))


def standard_error(values: FloatArray) -> FloatArray:
    """Of the mean, at each point; UserError for a single replicate, which has none."""
    _need_two(values)
    error: FloatArray = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    return error


def _need_two(values: FloatArray) -> None:
    if len(values) < 2:
        raise UserError(f"an interval needs at least 2 replicates; got {len(values)}")


NEAREST = 1e-12
"""To an end of the scale, in shares of it: the logit is still finite, and the error there is none."""
WEIGHT_OF_AN_END = 0.25
"""In replicates: the smallest with which all intervals of 4 to 100 capped replicates hold what they say."""


def _extended(values: FloatArray, ends: Ends) -> FloatArray:
    """The replicates between the two ends (replicates + 2, points)."""
    lowest = np.full(values.shape[1], ends.scale.lowest)
    return np.vstack([lowest, values, ends.latest])


def _weights(counts: FloatArray) -> FloatArray:
    """Those of replicates (resamples, replicates), with the ends beside them."""
    end = np.full((len(counts), 1), WEIGHT_OF_AN_END)
    return np.hstack([end, counts, end])


def _logit_mean_and_error(
    weights: FloatArray, extended: FloatArray, scale: Scale
) -> tuple[FloatArray, FloatArray]:
    """(resamples, points) each: the logit of the mean's place on the scale; its error by the delta method."""
    span, total = scale.highest - scale.lowest, weights.sum(axis=1, keepdims=True)
    share = np.clip(weighted_mean(weights, (extended - scale.lowest) / span), NEAREST, 1 - NEAREST)
    centred = (extended - extended.mean(axis=0)) / span
    spread = weighted_mean(weights, centred**2) - weighted_mean(weights, centred) ** 2
    error = np.sqrt(np.clip(spread, 0, None) / (total - 1))
    return special.logit(share), error / (share * (1 - share))


def _logit_band(values: FloatArray, extended: FloatArray, scale: Scale, critical: float) -> Band:
    """Where all replicates are at one end of the scale, so is a limit: that end may be the truth."""
    mean = average(values)
    (centre,), (error,) = _logit_mean_and_error(_weights(np.ones((1, len(values)))), extended, scale)
    low, high = (
        scale.lowest + (scale.highest - scale.lowest) * special.expit(centre + way * critical * error)
        for way in (-1, 1)
    )
    return Band(mean, np.minimum(low, mean), np.maximum(high, mean))


def _farthest(counts: FloatArray, extended: FloatArray, scale: Scale) -> FloatArray:
    """The largest distance of each resample's mean curve, in the sample's errors (resamples,)."""
    one = _weights(np.ones((1, counts.shape[1])))
    centre, error = _logit_mean_and_error(one, extended, scale)
    resampled, _ = _logit_mean_and_error(_weights(counts), extended, scale)
    distance = np.divide(np.abs(resampled - centre), error, out=np.zeros_like(resampled), where=error > 0)
    farthest: FloatArray = distance.max(axis=1)
    return farthest


_CHUNK_ELEMENTS = 4_000_000
"""Of resampled values at a time: 32 MB."""


def _resampled(replicates: int, width: int, resamples: int, rng: np.random.Generator) -> list[FloatArray]:
    """How often each replicate is drawn in each resample, in chunks that keep (chunk, width) small."""
    counts = rng.multinomial(replicates, np.full(replicates, 1 / replicates), size=resamples)
    chunks = max(1, -(-resamples * width // _CHUNK_ELEMENTS))
    return [chunk for chunk in np.array_split(counts.astype(np.float64), chunks) if len(chunk)]


ROUNDING = 1e-9
"""Of the largest value: a spread below it comes of rounding alone, with seven digits to spare."""


def _largest_t(weights: FloatArray, values: FloatArray) -> FloatArray:
    centred = values - values.mean(axis=0)
    replicates = len(values)
    mean = weighted_mean(weights, centred)
    spread = np.clip(weighted_mean(weights, centred**2) - mean**2, 0, None)
    error = np.sqrt(spread / (replicates - 1))
    varies = error > ROUNDING * np.abs(centred).max(axis=0)
    t = np.divide(np.abs(mean), error, out=np.zeros_like(mean), where=varies)
    largest: FloatArray = t.max(axis=1)
    return largest
