"""A run whose server ended before it was complete: what `--resume` goes on from."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from server.run import Simulation
from server.run_directory import EXPERIMENT, MANIFEST, RunDirectory
from server.trial import TrialResult
from swarm.config.experiment import Experiment
from swarm.errors import UserError


@dataclass(frozen=True)
class InterruptedRun:
    """The experiment as it was run, what tells this run from all others, and what is done of it."""

    directory: RunDirectory
    experiment: Experiment
    run_id: str
    trials: tuple[int, ...]
    """All of the run."""
    results: dict[int, TrialResult]
    """Of those that are complete."""
    changes: tuple[str, ...]
    """What `--set` said; the experiment has it."""
    simulation: Simulation | None
    """None for a run on the robots of a laboratory."""

    @property
    def file(self) -> Path:
        return self.directory.path / EXPERIMENT

    @classmethod
    def read(cls, path: Path) -> InterruptedRun:
        """UserError for what is no directory of a run that can go on."""
        manifest = _manifest(path)
        try:
            trials = tuple(dict.fromkeys(int(record["trial"]) for record in manifest["trials"]))
            (seed,) = {int(record["seed"]) for record in manifest["trials"]}
            run_id, moves = str(manifest["run_id"]), int(manifest["moves"])
            simulation, changes = manifest["simulation"], tuple(map(str, manifest["set"]))
            results = {int(trial): TrialResult(**found) for trial, found in manifest["results"].items()}
            simulated = None if simulation is None else Simulation(**simulation)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise UserError(f"{path / MANIFEST}: is not of a run that this version can go on with") from error
        if not set(trials) - set(results):
            raise UserError(f"{path}: all trials of the run are complete; there is nothing to resume")
        experiment = Experiment.load(path / EXPERIMENT).changed(seed=seed, moves=moves)
        directory = RunDirectory(path, is_new=False)
        return cls(directory, experiment, run_id, trials, results, changes, simulated)


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
