"""How large a paired difference is, with intervals: in its own unit, and as Cohen's d_z."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import optimize, special

from swarm.statistics.intervals import pointwise_t_band
from swarm.statistics.samples import Sample, paired_differences, refuse_zero_variance


@dataclass(frozen=True)
class EffectSize:
    """`mean_difference` in the samples' unit; `d_z` in standard deviations of the differences."""

    mean_difference: float
    mean_interval: tuple[float, float]
    d_z: float
    d_z_interval: tuple[float, float]
    pairs: int


def paired_effect_size(first: Sample, second: Sample, level: float = 0.95) -> EffectSize:
    """Of `first` minus `second`; PairingError if these are no pairs or never vary.

    The interval of d_z holds the values whose noncentral t distribution does not reject the t seen.
    """
    differences = paired_differences(first, second)
    refuse_zero_variance(differences.name, differences.values)
    pairs = len(differences.values)
    mean, spread = float(differences.values.mean()), float(differences.values.std(ddof=1))
    band = pointwise_t_band(differences.values[:, None], level=level)
    around_mean = float(band.low[0]), float(band.high[0])
    return EffectSize(mean, around_mean, mean / spread, d_z_interval(mean / spread, pairs, level), pairs)


def d_z_interval(d_z: float, pairs: int, level: float = 0.95) -> tuple[float, float]:
    """The interval of Cohen's d_z of `pairs` paired differences, from the noncentral t distribution."""
    low = _noncentrality(d_z, pairs, 0.5 + level / 2, step=-1)
    high = _noncentrality(d_z, pairs, 0.5 - level / 2, step=1)
    return low, high


NARROW = 1e-10
"""Far below the two decimals of d_z that anybody reads."""


def _noncentrality(d_z: float, pairs: int, probability: float, step: int) -> float:
    """The d for which a t as small as the one seen, or smaller, has this probability.

    It is looked for ever further from `d_z`; where scipy's distribution function gives up, it is 0 or 1.
    """
    root = float(np.sqrt(pairs))

    def excess(d: float) -> float:
        share = float(special.nctdtr(pairs - 1, d * root, d_z * root))
        return (float(d < d_z) if np.isnan(share) else share) - probability

    stride = step * (0.5 + abs(d_z)) / root
    near, far = d_z - stride, d_z + stride
    while np.sign(excess(near)) == np.sign(excess(far)):
        near, far = far, far + stride
    return float(optimize.brentq(excess, *sorted((near, far)), xtol=NARROW))
