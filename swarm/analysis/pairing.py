"""Which replicates may be compared pair by pair, and why others may not."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from swarm.analysis.curves import Curves, FloatArray, Sample
from swarm.errors import UserError

Measured = TypeVar("Measured", Sample, Curves)


class PairingError(UserError):
    """A paired test that was asked of samples which are no pairs; says why."""


def paired_differences(first: Measured, second: Measured) -> Measured:
    """`first` minus `second`, replicate by replicate, in the order of `first`.

    Raises PairingError if the two were not run with the same seeds, have fewer than two replicates,
    or were not measured at the same times.
    """
    names = f"{first.name} and {second.name}"
    order = _matching_rows(names, first.replicates, second.replicates)
    if isinstance(first, Curves) and isinstance(second, Curves) and not _same_times(first, second):
        raise PairingError(f"{names} cannot be paired: they were not measured at the same times")
    difference = first.values - second.values[order]
    return replace(first, name=f"{first.name} - {second.name}", values=difference)


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
