"""What a comparison may look at: the runs of its figure's conditions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from swarm.gridworld.arena import shortest_path
from swarm.gridworld.condition import Condition
from swarm.learning.random import spawned_generator
from swarm.paper.results import Results
from swarm.statistics.samples import Curves
from swarm.statistics.survival import CensoredTimes, times_to_threshold

ENOUGH_RUNS = 100
"""The paper's number: what is not significant with so many is not there to the paper's standard."""


@dataclass(frozen=True)
class Evidence:
    """Results up to the end of the time that the claim's figure shows."""

    results: Results
    horizon_steps: int

    @property
    def seed(self) -> int:
        return self.results.store.seed

    @property
    def enough_runs(self) -> bool:
        return self.results.runs >= ENOUGH_RUNS

    def compared(self, one: Condition, other: Condition, *, whole_run: bool = False) -> tuple[Curves, Curves]:
        """The points of two conditions that are tested.

        Pairs of learners are compared with pairs. With a single learner only the first of a pair can be: the
        mean of two varies less than one, and a test that flips signs would find that.
        """
        single = one.learners != other.learners
        first, second = (self._shown(each, whole_run, single) for each in (one, other))
        end = min(first.times[-1], second.times[-1])
        return first.between(0, end), second.between(0, end)

    def _shown(self, condition: Condition, whole_run: bool, single: bool) -> Curves:
        if whole_run:
            return self.results.whole_run(condition)
        return self.results.tested(condition, self.horizon_steps, single=single)

    def generator(self, *names: str) -> np.random.Generator:
        """The randomness of one comparison's resampling."""
        return spawned_generator(self.seed, " ".join(names), 0, "claims", "bootstrap")

    def curves(self, condition: Condition) -> Curves:
        """All points."""
        return self.results.curves(condition, self.horizon_steps)

    def arrivals(self, condition: Condition, length: float | None = None) -> CensoredTimes:
        """When each run's best path first came down to a length, that of the shortest path by default."""
        threshold = shortest_path(condition.arena) if length is None else length
        return times_to_threshold(self.curves(condition), threshold)
