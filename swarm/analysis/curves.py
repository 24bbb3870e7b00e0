"""What a study measures: one number, or one curve over time, of each replicate.

A replicate is what is independent of the others: one run. Two learners that copy each other are
one replicate, not two, and enter as their average (`average_of_learners`).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from swarm.errors import UserError

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Sample:
    """One number of each replicate: `values` (replicates,); `replicates` names each row's seed and run."""

    name: str
    values: FloatArray
    replicates: tuple[Hashable, ...]

    def __post_init__(self) -> None:
        _check_rows(self.name, self.values, self.replicates, dimensions=1)


@dataclass(frozen=True)
class Curves:
    """One curve of each replicate: `values` (replicates, points) at ascending `times` (points,)."""

    name: str
    times: FloatArray
    values: FloatArray
    replicates: tuple[Hashable, ...]

    def __post_init__(self) -> None:
        _check_rows(self.name, self.values, self.replicates, dimensions=2)
        if self.values.shape[1] != len(self.times):
            raise UserError(
                f"{self.name}: {self.values.shape[1]} values a replicate, {len(self.times)} times"
            )
        if np.any(np.diff(self.times) <= 0):
            raise UserError(f"{self.name}: the times do not ascend")

    def between(self, start: float, end: float) -> Curves:
        """The part of the curves with start <= time <= end."""
        inside = (self.times >= start) & (self.times <= end)
        return Curves(self.name, self.times[inside], self.values[:, inside], self.replicates)

    def every(self, points: int) -> Curves:
        """Each `points`-th point, counted so that the last of every group of `points` is kept."""
        chosen = slice(points - 1, None, points)
        return Curves(self.name, self.times[chosen], self.values[:, chosen], self.replicates)


def average_of_learners(values: npt.NDArray[np.generic]) -> FloatArray:
    """(learners, ...) of one run to (...): learners that influence each other are one replicate."""
    averaged: FloatArray = np.asarray(values, dtype=np.float64).mean(axis=0)
    return averaged


def _check_rows(name: str, values: FloatArray, replicates: tuple[Hashable, ...], dimensions: int) -> None:
    if values.ndim != dimensions or len(values) != len(replicates):
        raise UserError(f"{name}: values of shape {values.shape} for {len(replicates)} replicates")
    if len(set(replicates)) != len(replicates):
        raise UserError(f"{name}: a replicate occurs twice; average what belongs to one run")
    if not np.all(np.isfinite(values)):
        raise UserError(f"{name}: a value is not finite; censor or drop it before any statistics")
