"""Averages over replicates: the mean and the interquartile mean."""

from __future__ import annotations

from typing import Protocol

import numpy as np

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
