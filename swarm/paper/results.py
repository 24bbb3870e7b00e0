"""The runs of a directory as curves and R values, each condition read once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from swarm.errors import RunFailedError
from swarm.gridworld.condition import Condition
from swarm.paper.store import RunStore
from swarm.statistics.samples import Curves, FloatArray, average_of_learners

if TYPE_CHECKING:
    import polars as pl

TESTED_POINTS = 200
"""Points of a curve that statistics are made of: every 100,000 steps of a run of 20m."""


class Results:
    """What `runs` runs of each condition have shown."""

    def __init__(self, store: RunStore, runs: int) -> None:
        self.store = store
        self.runs = runs
        self._curves: dict[str, Curves] = {}

    def curves(self, condition: Condition, horizon_steps: int) -> Curves:
        """Best path lengths (runs, points) at every evaluation up to the horizon.

        Two learners that copy each other are averaged: they are one replicate.
        """
        if condition.name not in self._curves:
            self._curves[condition.name] = self._read(condition)
        return self._curves[condition.name].between(0, self.horizon(horizon_steps))

    def horizon(self, horizon_steps: int) -> int:
        """The end of the time shown, in steps: the study's, or this directory's number of steps."""
        return horizon_steps if self.store.steps is None else self.store.steps

    def tested(self, condition: Condition, horizon_steps: int) -> Curves:
        """The same curves at about `TESTED_POINTS` points."""
        curves = self.curves(condition, horizon_steps)
        return curves.every(max(1, len(curves.times) // TESTED_POINTS))

    def ratios(self, condition: Condition) -> FloatArray:
        """R_i of the first learner at the end of each run (runs, paths); NaN where it had fewer paths."""
        rows = [self._load(condition, run)["ratios"][0].to_numpy() for run in range(self.runs)]
        table = np.full((len(rows), max(map(len, rows))), np.nan)
        for row, ratios in zip(table, rows, strict=True):
            row[: len(ratios)] = ratios
        return table

    def _read(self, condition: Condition) -> Curves:
        rows = [_lengths(self._load(condition, run)) for run in range(self.runs)]
        points = min(map(len, rows))
        times = condition.evaluate_every * np.arange(1.0, points + 1)
        replicates = tuple((self.store.seed, run) for run in range(self.runs))
        return Curves(condition.name, times, np.stack([row[:points] for row in rows]), replicates)

    def _load(self, condition: Condition, run: int) -> pl.DataFrame:
        try:
            return self.store.load(condition, run)
        except Exception as error:
            raise RunFailedError(
                f"run {run} of {condition.name} in {self.store.root} cannot be read ({error}); delete its "
                "file and start again: only what is missing is run"
            ) from error


def _lengths(frame: pl.DataFrame) -> FloatArray:
    flat = frame["best_path_length"].explode(empty_as_null=False).to_numpy()
    return average_of_learners(flat.reshape(len(frame), -1))
