"""The runs of a directory as curves and R values, each condition read once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from swarm.errors import RunFailedError
from swarm.gridworld.arena import shortest_path
from swarm.gridworld.condition import Condition
from swarm.gridworld.state import UNLIMITED
from swarm.paper.store import RunStore
from swarm.statistics.samples import Curves, FloatArray, Scale, average_of_learners

if TYPE_CHECKING:
    import polars as pl

TESTED_POINTS = 200
"""Points of a curve that statistics are made of: every 100,000 steps of a run of 20m."""
WHOLE_RUN_STEPS = 5000
"""Between the points of a run to 100,000 reachings of the goal: 200 to 300 of them, too."""


class Results:
    """What `runs` runs of each condition have shown."""

    def __init__(self, store: RunStore, runs: int) -> None:
        self.store = store
        self.runs = runs
        self._curves: dict[tuple[str, int | None], Curves] = {}

    def curves(self, condition: Condition, horizon_steps: int) -> Curves:
        """Best path lengths (runs, points) at every evaluation up to the horizon.

        Two learners that copy each other are averaged: they are one replicate.
        """
        return self.of_learner(condition, None).between(0, self.horizon(horizon_steps))

    def of_learner(self, condition: Condition, learner: int | None) -> Curves:
        """The curves of one learner of each run, or of the mean of them all, at every evaluation."""
        key = condition.name, learner
        if key not in self._curves:
            self._curves[key] = self._read(condition, learner)
        return self._curves[key]

    def whole_run(self, condition: Condition) -> Curves:
        """The curves up to the goal reachings that end the shortest run, evenly spaced.

        A directory that cuts runs to a number of steps has them up to there.
        """
        curves = self.of_learner(condition, None)
        every = self.store.condition(condition).later_every
        even = curves.times % (WHOLE_RUN_STEPS if every else 1) == 0
        return replace(curves, times=curves.times[even], values=curves.values[:, even])

    def horizon(self, horizon_steps: int) -> int:
        """The end of the time shown, in steps: the study's, or this directory's number of steps."""
        return horizon_steps if self.store.steps is None else self.store.steps

    def tested(self, condition: Condition, horizon_steps: int, *, single: bool = False) -> Curves:
        """The same curves at about `TESTED_POINTS` points; `single`: of the first learner alone."""
        learner = 0 if single else None
        curves = self.of_learner(condition, learner).between(0, self.horizon(horizon_steps))
        return curves.every(max(1, len(curves.times) // TESTED_POINTS))

    def ratios(self, condition: Condition) -> FloatArray:
        """R_i of the first learner at the end of each run (runs, paths); NaN where it had fewer paths."""
        return self.of_memory(condition, "ratios")

    def of_memory(self, condition: Condition, column: str) -> FloatArray:
        """ "ratios" or "replicated" of the first learner's paths (runs, paths); NaN where it had fewer."""
        rows = [self._load(condition, run)[column][0].to_numpy() for run in range(self.runs)]
        table = np.full((len(rows), max(map(len, rows))), np.nan)
        for row, numbers in zip(table, rows, strict=True):
            row[: len(numbers)] = numbers
        return table

    def tally(self, condition: Condition) -> FloatArray:
        """What each run's first learner did how often (runs, 4); places as in `swarm.gridworld.state`."""
        rows = [self._load(condition, run)["tally"][0].to_numpy() for run in range(self.runs)]
        return np.array(rows, dtype=np.float64)

    def q_errors(self, condition: Condition) -> FloatArray:
        """The greatest distance of a first learner's Q value from its final one, at the end (runs,)."""
        return np.array([self._load(condition, run)["q_error"][0] for run in range(self.runs)])

    def _read(self, condition: Condition, learner: int | None) -> Curves:
        rows = [_lengths(self._load(condition, run), learner) for run in range(self.runs)]
        points = min(map(len, rows))
        times = self.store.condition(condition).evaluated_steps(UNLIMITED)[:points].astype(np.float64)
        replicates = tuple((self.store.seed, run) for run in range(self.runs))
        scale = Scale(shortest_path(condition.arena), float(condition.arena.longest_path))
        return Curves(condition.name, times, np.stack([row[:points] for row in rows]), replicates, scale)

    def _load(self, condition: Condition, run: int) -> pl.DataFrame:
        try:
            return self.store.load(condition, run)
        except Exception as error:
            raise RunFailedError(
                f"run {run} of {condition.name} in {self.store.root} cannot be read ({error}); delete its "
                "file and start again: only what is missing is run"
            ) from error


def _lengths(frame: pl.DataFrame, learner: int | None) -> FloatArray:
    flat = frame["best_path_length"].explode(empty_as_null=False).to_numpy()
    rows = flat.reshape(len(frame), -1)
    return average_of_learners(rows if learner is None else rows[learner : learner + 1])
