"""How figures are reproduced: what the command line asks for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from swarm.errors import UserError
from swarm.experiments.executors import check_scheduler
from swarm.experiments.study import Study


@dataclass(frozen=True)
class Settings:
    """How figures are reproduced; `runs` and `steps` None mean as many as the paper has."""

    runs: int | None = None
    steps: int | None = None
    seed: int = 1
    out: Path | None = None
    jobs: int = 1
    scheduler: str = "processes"

    def __post_init__(self) -> None:
        for name, value in (("runs", self.runs), ("steps", self.steps), ("jobs", self.jobs)):
            if value is not None and value < 1:
                raise UserError(f"--{name} {value}: give at least 1")
        if self.seed < 0:
            raise UserError(f"--seed {self.seed}: give 0 or more")
        check_scheduler(self.scheduler)

    @property
    def root(self) -> Path:
        """--out, or runs/reproduce/seed-1: a directory for each seed and number of steps."""
        name = f"seed-{self.seed}" if self.steps is None else f"seed-{self.seed}-steps-{self.steps}"
        return Path("runs") / "reproduce" / name if self.out is None else self.out

    def runs_of(self, study: Study) -> int:
        return study.runs if self.runs is None else self.runs
