"""A run: its trials, each in an environment of its own, and what they leave behind."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from server.experiment_text import experiment_bytes
from server.processes.environment import Environment
from server.progress import RunProgress
from server.recording.provenance import versions
from server.recording.recorder import digest
from server.run_directory import MANIFEST, RunDirectory
from server.trial import Onlooker, TrialResult
from server.trial_player import TrialPlayer, play_together
from swarm.config.experiment import Experiment
from swarm.errors import UserError, in_words


@dataclass(frozen=True)
class Simulation:
    """How a run is simulated."""

    speed: float | None
    """So many times as fast as life; None for lockstep."""
    emulate: bool


@dataclass
class Run:
    """Everything that a run needs; `run` does it and returns what `--json` prints."""

    experiment: Experiment
    file: Path
    directory: RunDirectory
    environment: Environment
    trials: Sequence[int]
    """Their numbers, in order."""
    progress: RunProgress
    run_id: str = ""
    """Random, and new with every run; empty in a lockstep, which nobody can join and anybody can repeat."""
    changes: Sequence[str] = ()
    """What `--set` said in place of the file's values; the experiment has it."""
    jobs: int = 1
    """Trials at a time; more than one on simulated robots in lockstep alone."""
    scheduler: str = "processes"
    """Where those are played, if there are several at a time."""
    simulation: Simulation | None = None
    """How it is simulated; None on the robots of a laboratory."""
    onlookers: Sequence[Onlooker] = ()
    results: dict[int, TrialResult] = field(default_factory=dict)
    """By trial; those that an earlier server completed are not repeated."""
    versions: dict[str, str] = field(default_factory=versions)

    def run(self) -> dict[str, Any]:
        """All trials; the run's directory is complete after each of them."""
        with self.directory.held():
            return self._held()

    def _held(self) -> dict[str, Any]:
        began = time.monotonic()
        kept = self._begin()
        to_do = [trial for trial in self.trials if trial not in self.results]
        state = "interrupted"
        try:
            state = self._play(to_do, kept)
        finally:
            self._write_manifest(state)
            summary = self._summary(to_do, time.monotonic() - began)
            self.directory.write_json("run.json", {**summary, **self._circumstances()})
            self.directory.release()
        return summary

    def _begin(self) -> Path:
        """What stands in the directory before the first trial; nothing is left if there is no room for it."""
        try:
            self.directory.reserve()
            kept = self.directory.keep_experiment(experiment_bytes(self.file, self.changes))
            self.directory.close_logs()
            self._write_manifest("running")
        except OSError as error:
            self.directory.remove()
            raise UserError(f"{self.directory.path}: {in_words(error)}") from error
        return kept

    def _play(self, trials: Sequence[int], file: Path) -> str:
        """One after the other, or several at a time; what became of them."""
        player = TrialPlayer(
            self.experiment,
            file,
            self.changes,
            self.directory,
            self.versions,
            self.run_id,
            self.onlookers,
            is_repeatable=self.simulation is not None,
        )
        if self.jobs > 1:
            play_together(player, trials, self.scheduler, self.jobs, self._note_and_show)
            return "complete"
        for trial in trials:
            self.progress.begin(trial)
            player.play(trial, self.environment, self.progress.show, self._note)
            if self.results[trial].stopped:
                return "stopped"
        return "complete"

    def _note(self, trial: int, result: TrialResult) -> None:
        self.results[trial] = result
        if result.complete:
            self._write_manifest("running")

    def _note_and_show(self, trial: int, result: TrialResult) -> None:
        self._note(trial, result)
        self.progress.played(trial, len(self.results))

    def _summary(self, done: Sequence[int], wall_s: float) -> dict[str, Any]:
        """Of the run; its pace is that of the trials that this server has done."""
        logs = [log for trial in self.trials for log in self.directory.logs(trial)]
        paced_s = sum(self.results[trial].sim_s for trial in done if trial in self.results)
        return {
            "run": str(self.directory.path),
            "run_id": self.run_id,
            "log": [str(log) for log in logs],
            "digest": digest(logs),
            "moves": sum(result.moves for result in self.results.values()),
            "sim_s": round(sum(result.sim_s for result in self.results.values()), 3),
            "wall_s": round(wall_s, 3),
            "real_time_factor": round(paced_s / wall_s, 2),
        }

    def _circumstances(self) -> dict[str, Any]:
        """What differs between two repetitions of a run."""
        return {
            "ended": datetime.now(UTC).isoformat(),
            "host": socket.gethostname(),
            "command": sys.argv,
            "trials": [asdict(result) for _, result in sorted(self.results.items())],
        }

    def _write_manifest(self, state: str) -> None:
        """Conditions x trials x seeds, one record each."""
        run = self.experiment.run
        complete = {trial: asdict(result) for trial, result in self.results.items() if result.complete}
        records = [
            {
                "condition": robot.group,
                "robot": robot.id,
                "role": robot.role.value,
                "trial": trial,
                "seed": run.seed,
                "log": self.directory.log(trial).name,
                "state": "complete" if trial in complete else state,
            }
            for trial in self.trials
            for robot in self.experiment.robot
        ]
        about = {"name": run.name, "run_id": self.run_id, "moves": run.moves, "set": list(self.changes)}
        simulation = asdict(self.simulation) if self.simulation else None
        content = {**about, "simulation": simulation, "trials": records, "results": complete}
        self.directory.write_json(MANIFEST, content)
