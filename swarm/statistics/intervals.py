"""Averages over replicates, and 95 % bands around them: pointwise, and over the whole curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import special

from swarm.errors import UserError
from swarm.statistics.samples import FloatArray


class Average(Protocol):
    """An average of the rows of `values` (replicates, points) for each row of `weights`."""

    def __call__(self, weights: FloatArray, values: FloatArray, /) -> FloatArray:
        """(resamples, points): row i counts replicate j `weights[i, j]` times."""


def weighted_mean(weights: FloatArray, values: FloatArray) -> FloatArray:
    """The mean of each point."""
    mean: FloatArray = weights @ values / weights.sum(axis=1, keepdims=True)
    return mean


def weighted_iqm(weights: FloatArray, values: FloatArray) -> FloatArray:
    """The interquartile mean of each point: the mean of the middle half of the replicates.

    A replicate that a quartile cuts through counts with the part of it that lies inside, so that no
    number of replicates needs a special case.
    """
    order = np.argsort(values, axis=0, kind="stable")
    ascending = np.take_along_axis(values, order, axis=0)
    reached = np.cumsum(weights[:, order], axis=1)
    total = reached[:, -1:, :]
    inside = np.diff(np.clip(reached, total / 4, total * 3 / 4), axis=1, prepend=total / 4)
    averages: FloatArray = (inside * ascending).sum(axis=1) / (total[:, 0, :] / 2)
    return averages


def average(values: FloatArray, of: Average = weighted_mean) -> FloatArray:
    """The average (points,) of the rows of `values` (replicates, points)."""
    averaged: FloatArray = of(np.ones((1, len(values))), values)[0]
    return averaged


_CHUNK_ELEMENTS = 4_000_000


@dataclass(frozen=True)
class Band:
    """A curve with the limits around it, each (points,)."""

    centre: FloatArray
    low: FloatArray
    high: FloatArray


def pointwise_t_band(values: FloatArray, level: float = 0.95) -> Band:
    """Student's t interval of the mean at each point of `values` (replicates, points)."""
    error = standard_error(values)
    half = special.stdtrit(len(values) - 1, 0.5 + level / 2) * error
    mean = average(values)
    return Band(mean, mean - half, mean + half)


def simultaneous_band(
    values: FloatArray, rng: np.random.Generator, level: float = 0.95, resamples: int = 2000
) -> Band:
    """The bootstrap max-T band of the mean curve.

    The critical value is the quantile, over resamples, of the largest studentised distance
    max_t |mean*(t) - mean(t)| / se*(t), each resample with its own standard error.
    """
    error, mean = standard_error(values), average(values)
    largest = np.concatenate(
        [_largest_t(weights, values) for weights in _resampled(len(values), values.shape[1], resamples, rng)]
    )
    half = np.quantile(largest, level) * error
    return Band(mean, mean - half, mean + half)


def bootstrap_bands(
    values: FloatArray,
    rng: np.random.Generator,
    of: Average = weighted_mean,
    level: float = 0.95,
    resamples: int = 2000,
) -> tuple[Band, Band]:
    """The percentile band and the simultaneous band of any average, such as the interquartile mean.

    The simultaneous band scales the bootstrap's standard deviation of each point by the quantile of the
    largest standardised distance over the curve.
    """
    _need_two(values)
    centre = average(values, of)
    chunks = _resampled(len(values), values.shape[0] * values.shape[1], resamples, rng)
    drawn = np.concatenate([of(weights, values) for weights in chunks])
    low, high = np.quantile(drawn, [(1 - level) / 2, (1 + level) / 2], axis=0)
    scale = drawn.std(axis=0)
    distance = np.divide(np.abs(drawn - centre), scale, out=np.zeros_like(drawn), where=scale > 0)
    half = np.quantile(distance.max(axis=1), level) * scale
    return Band(centre, low, high), Band(centre, centre - half, centre + half)


def standard_error(values: FloatArray) -> FloatArray:
    """Of the mean, at each point; UserError for a single replicate, which has none."""
    _need_two(values)
    error: FloatArray = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    return error


def _need_two(values: FloatArray) -> None:
    if len(values) < 2:
        raise UserError(f"an interval needs at least 2 replicates; got {len(values)}")


def _resampled(replicates: int, width: int, resamples: int, rng: np.random.Generator) -> list[FloatArray]:
    """How often each replicate is drawn in each resample, in chunks that keep (chunk, width) small."""
    counts = rng.multinomial(replicates, np.full(replicates, 1 / replicates), size=resamples)
    chunks = max(1, -(-resamples * width // _CHUNK_ELEMENTS))
    return [chunk for chunk in np.array_split(counts.astype(np.float64), chunks) if len(chunk)]


def _largest_t(weights: FloatArray, values: FloatArray) -> FloatArray:
    centred = values - values.mean(axis=0)
    replicates = len(values)
    mean = weighted_mean(weights, centred)
    spread = np.clip(weighted_mean(weights, centred**2) - mean**2, 0, None)
    error = np.sqrt(spread / (replicates - 1))
    varies = error > 1e-9 * np.abs(centred).max(axis=0)
    t = np.divide(np.abs(mean), error, out=np.zeros_like(mean), where=varies)
    largest: FloatArray = t.max(axis=1)
    return largest
