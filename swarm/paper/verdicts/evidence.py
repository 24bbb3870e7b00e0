"""What a comparison may look at: the runs of its figure's conditions."""

from __future__ import annotations

from dataclasses import dataclass

from swarm.gridworld.arena import distances
from swarm.gridworld.condition import Condition
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

    def tested(self, condition: Condition) -> Curves:
        """The points of a condition's curves that are tested."""
        return self.results.tested(condition, self.horizon_steps)

    def curves(self, condition: Condition) -> Curves:
        """All points."""
        return self.results.curves(condition, self.horizon_steps)

    def arrivals(self, condition: Condition) -> CensoredTimes:
        """When each run found a shortest path."""
        shortest = float(distances(condition.arena)[condition.arena.grid.start])
        return times_to_threshold(self.curves(condition), shortest)
