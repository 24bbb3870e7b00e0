"""p values of several claims at once: Holm's bound on any error, Benjamini and Hochberg's on their share."""

from __future__ import annotations

import numpy as np
from scipy import stats

from swarm.statistics.samples import FloatArray


def holm(p: FloatArray) -> FloatArray:
    """Adjusted p values (Holm 1979): at most 5 % of all families have one at or below 0.05 by chance."""
    order = np.argsort(p, kind="stable")
    steps = p[order] * np.arange(len(p), 0, -1)
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return adjusted


def benjamini_hochberg(p: FloatArray) -> FloatArray:
    """Adjusted p values: of those at or below 0.05 at most 5 % are there by chance, on average."""
    adjusted: FloatArray = np.asarray(stats.false_discovery_control(p)) if len(p) else p
    return adjusted
