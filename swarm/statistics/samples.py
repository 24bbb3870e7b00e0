"""What a study measures: numbers or curves of replicates, and which may be paired."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from swarm.errors import UserError

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Scale:
    """What a value can be at least and at most, such as a path's length: the shortest, and the cap."""

    lowest: float
    highest: float


@dataclass(frozen=True)
class Sample:
    """One number of each replicate: `values` (replicates,); `replicates` names each row's seed and run."""

    name: str
    values: FloatArray
    replicates: tuple[Hashable, ...]
    scale: Scale | None = None
    """None where the values know no bounds."""

    def __post_init__(self) -> None:
        _check_rows(self.name, self.values, self.replicates, dimensions=1)


@dataclass(frozen=True)
class Curves:
    """One curve of each replicate: `values` (replicates, points) at ascending `times` (points,)."""

    name: str
    times: FloatArray
    values: FloatArray
    replicates: tuple[Hashable, ...]
    scale: Scale | None = None
    """None where the values know no bounds."""

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
        return replace(self, times=self.times[inside], values=self.values[:, inside])

    def every(self, points: int) -> Curves:
        """Each `points`-th point, counted so that the last of every group of `points` is kept."""
        chosen = slice(points - 1, None, points)
        return replace(self, times=self.times[chosen], values=self.values[:, chosen])


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


def mean_level(curves: Curves) -> Sample:
    """The mean over the curve's points of each replicate, in the curve's unit."""
    return Sample(curves.name, curves.values.mean(axis=1), curves.replicates, curves.scale)


Measured = TypeVar("Measured", Sample, Curves)


class PairingError(UserError):
    """A paired test that was asked of samples which are no pairs; says why."""


def paired_differences(first: Measured, second: Measured) -> Measured:
    """`first` minus `second`, replicate by replicate, in the order of `first`.

    They have no scale: a difference as great as the scale is possible, and never met.
    Raises PairingError if the two were not run with the same seeds, have fewer than two replicates,
    or were not measured at the same times.
    """
    names = f"{first.name} and {second.name}"
    order = _matching_rows(names, first.replicates, second.replicates)
    if isinstance(first, Curves) and isinstance(second, Curves) and not _same_times(first, second):
        raise PairingError(f"{names} cannot be paired: they were not measured at the same times")
    difference = first.values - second.values[order]
    return replace(first, name=f"{first.name} - {second.name}", values=difference, scale=None)


def refuse_zero_variance(name: str, differences: FloatArray) -> None:
    """A t statistic needs differences that vary; PairingError if they are all the same number."""
    if np.all(differences == differences[0]):
        raise PairingError(
            f"{name} cannot be tested: every pair differs by {differences[0]:g} (zero variance); "
            "are the two samples copies of each other?"
        )


def _matching_rows(names: str, first: tuple[Hashable, ...], second: tuple[Hashable, ...]) -> list[int]:
    unmatched = set(first) ^ set(second)
    if unmatched:
        example = min(map(str, unmatched))
        raise PairingError(
            f"{names} cannot be paired: {len(unmatched)} replicates (such as {example}) are in only one "
            "of them; run both with the same seeds"
        )
    if len(first) < 2:
        raise PairingError(f"{names} cannot be tested: {len(first)} pair; at least 2 are needed")
    rows = {replicate: row for row, replicate in enumerate(second)}
    return [rows[replicate] for replicate in first]


def _same_times(first: Curves, second: Curves) -> bool:
    return np.array_equal(first.times, second.times)
