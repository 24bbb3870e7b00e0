"""A run whose server ended before its trial did: what `swarm-server --resume` goes on from."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from server.run_directory import EXPERIMENT, MANIFEST, RunDirectory
from swarm.config.experiment import Experiment
from swarm.errors import UserError


@dataclass(frozen=True)
class InterruptedRun:
    """The experiment as it was run, and what tells this run from all others."""

    directory: RunDirectory
    experiment: Experiment
    run_id: str
    trial: int
    changes: tuple[str, ...]
    """What `--set` said; the experiment has it."""

    @property
    def file(self) -> Path:
        return self.directory.path / EXPERIMENT

    @classmethod
    def read(cls, path: Path) -> InterruptedRun:
        """UserError for what is no directory of a run that can go on, or if its server still records."""
        manifest = _manifest(path)
        try:
            (trial,) = {int(record["trial"]) for record in manifest["trials"]}
            (seed,) = {int(record["seed"]) for record in manifest["trials"]}
            states = {str(record["state"]) for record in manifest["trials"]}
            run_id, moves = str(manifest["run_id"]), int(manifest["moves"])
            changes = tuple(map(str, manifest.get("set", ())))
        except (KeyError, TypeError, ValueError) as error:
            raise UserError(f"{path / MANIFEST}: is not of a single trial that others can join") from error
        if not run_id:
            raise UserError(f"{path}: was simulated; a simulation is not resumed, it is run again")
        if states == {"complete"}:
            raise UserError(f"{path}: trial {trial} is complete; there is nothing to resume")
        experiment = Experiment.load(path / EXPERIMENT).changed(seed=seed, moves=moves)
        return cls(RunDirectory.reopened(path, trial), experiment, run_id, trial, changes)


def _manifest(path: Path) -> dict[str, Any]:
    try:
        content = json.loads((path / MANIFEST).read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise UserError(f"{path}: has no {MANIFEST}; --resume wants the directory of a run") from error
    except (OSError, RecursionError, ValueError) as error:
        raise UserError(f"{path / MANIFEST}: cannot be read ({error})") from error
    if not isinstance(content, dict):
        raise UserError(f"{path / MANIFEST}: is no manifest of a run")
    return content
