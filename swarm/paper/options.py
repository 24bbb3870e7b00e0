"""How figures are reproduced: what the command line asks for, and whether it fits the machine."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from swarm.config.limits import LARGEST_SEED, MOST_JOBS
from swarm.errors import UserError
from swarm.gridworld.condition import Condition
from swarm.paper.readings import DEFAULT, Readings
from swarm.paper.store import RunStore
from swarm.paper.study import Study
from swarm.parallel import check_scheduler


@dataclass(frozen=True)
class Settings:
    """How figures are reproduced; `runs` and `steps` None mean as many as the paper has."""

    runs: int | None = None
    steps: int | None = None
    seed: int = 1
    out: Path | None = None
    jobs: int = 1
    scheduler: str = "processes"
    readings: Readings = DEFAULT

    def __post_init__(self) -> None:
        for name, value in (("runs", self.runs), ("steps", self.steps), ("jobs", self.jobs)):
            if value is not None and value < 1:
                raise UserError(f"--{name} {value}: give at least 1")
        if self.jobs > MOST_JOBS:
            raise UserError(f"--jobs {self.jobs}: give at most {MOST_JOBS}")
        if not 0 <= self.seed <= LARGEST_SEED:
            raise UserError(f"--seed {self.seed}: give 0 to {LARGEST_SEED}")
        check_scheduler(self.scheduler)

    @property
    def root(self) -> Path:
        """--out, or runs/reproduce/seed-1: a directory for each seed and number of steps."""
        name = f"seed-{self.seed}" if self.steps is None else f"seed-{self.seed}-steps-{self.steps}"
        return Path("runs") / "reproduce" / name if self.out is None else self.out

    def runs_of(self, study: Study) -> int:
        return study.runs if self.runs is None else self.runs


BYTES_A_VALUE = 8 * 3
"""A value of a curve as it is read, averaged over learners and tested."""
BYTES_A_RUN = 100_000
"""What a run costs apart from its curve: its file, its task and its place in tests."""


def check_sizes(store: RunStore, runs_of: Mapping[Condition, int], jobs: int) -> None:
    """UserError if so many runs of these conditions leave no points, or more than the memory holds."""
    needed = 0
    for condition, runs in runs_of.items():
        cut = store.condition(condition)
        if cut.point_limit < 1:
            raise UserError(
                f"--steps {cut.steps} is too short: the best path of {cut.name} is evaluated every "
                f"{cut.evaluate_every} steps; give at least that many"
            )
        needed += (
            BYTES_A_VALUE * (cut.point_limit + cut.later_points) * (runs + 2 * jobs) + BYTES_A_RUN * runs
        )
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > memory:
        raise UserError(
            f"so many runs and steps would need {needed / 1e9:,.1f} GB of memory, and this machine has "
            f"{memory / 1e9:,.1f} GB; give fewer --runs or --steps"
        )
