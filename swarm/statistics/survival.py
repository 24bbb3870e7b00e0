"""When each replicate's curve comes down to a threshold; some never do while they are watched.

Such a replicate is right-censored: it says "later than the end", not "at the end". Leaving it out or
counting it as the end would favour the slow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special, stats

from swarm.statistics.samples import BoolArray, Curves, FloatArray


@dataclass(frozen=True)
class CensoredTimes:
    """`times` (replicates,): when it arrived, or, where `observed` is False, until when it had not."""

    times: FloatArray
    observed: BoolArray


@dataclass(frozen=True)
class RestrictedMean:
    """The mean time up to a horizon, in which a replicate that has not arrived counts as the horizon."""

    time: float
    low: float
    high: float
    horizon: float


def times_to_threshold(curves: Curves, threshold: float, lasting: bool = False) -> CensoredTimes:
    """The first time at which each curve is at or below `threshold`; `lasting`: and from then on stays so."""
    below = curves.values <= threshold
    if lasting:
        below = np.logical_and.accumulate(below[:, ::-1], axis=1)[:, ::-1]
    observed: BoolArray = np.asarray(below.any(axis=1))
    times = np.where(observed, curves.times[below.argmax(axis=1)], curves.times[-1])
    return CensoredTimes(times, observed)


def median_time(censored: CensoredTimes) -> float | None:
    """The Kaplan-Meier median: when half have arrived; None if fewer did while they were watched."""
    survival = _survival(censored)
    arrived = np.flatnonzero(survival.probabilities <= 0.5 + 1e-12)
    return float(survival.quantiles[arrived[0]]) if len(arrived) else None


def restricted_mean_time(censored: CensoredTimes, horizon: float, level: float = 0.95) -> RestrictedMean:
    """The area under the Kaplan-Meier curve up to `horizon`, with a normal interval.

    The variance is Greenwood's: the sum over arrivals of (area still to come)^2 d / (n (n - d)).
    """
    survival = _survival(censored)
    before = survival.quantiles < horizon
    edges = np.concatenate([[0.0], survival.quantiles[before], [horizon]])
    heights = np.concatenate([[1.0], survival.probabilities[before]])
    areas = heights * np.diff(edges)
    mean = float(areas.sum())
    to_come = areas[::-1].cumsum()[::-1][1:]
    half = special.ndtri(0.5 + level / 2) * np.sqrt(_greenwood(censored, survival.quantiles[before], to_come))
    return RestrictedMean(mean, max(0.0, mean - half), min(horizon, mean + half), horizon)


def _greenwood(censored: CensoredTimes, arrivals: FloatArray, to_come: FloatArray) -> float:
    at_risk = (censored.times[None, :] >= arrivals[:, None]).sum(axis=1)
    arrived = ((censored.times[None, :] == arrivals[:, None]) & censored.observed).sum(axis=1)
    left = at_risk - arrived
    terms = np.divide(to_come**2 * arrived, at_risk * left, out=np.zeros_like(to_come), where=left > 0)
    return float(terms.sum())


def _survival(censored: CensoredTimes) -> stats.EmpiricalDistributionFunction:
    data = stats.CensoredData(censored.times[censored.observed], right=censored.times[~censored.observed])
    return stats.ecdf(data).sf
