"""A run: its trials one after the other, each in an environment of its own."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from server.conductor.conductor import Conductor
from server.conductor.earlier import earlier_progress
from server.processes.environment import Environment, TrialPlan
from server.progress import RunProgress
from server.recording.foxglove_views import Views
from server.recording.health import Health
from server.recording.provenance import metadata, versions
from server.recording.recorder import Recorder, digest
from server.run_directory import MANIFEST, RunDirectory
from server.trial import Trial, TrialResult
from swarm.config.experiment import Experiment
from swarm.errors import UserError, in_words
from swarm.runtime.identity import RunIdentity


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
    results: list[TrialResult] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=versions)

    def run(self) -> dict[str, Any]:
        """All trials; the run's directory is complete after each of them."""
        with self.directory.held():
            return self._held()

    def _held(self) -> dict[str, Any]:
        began = time.monotonic()
        copy = self._begin()
        state = "interrupted"
        try:
            for trial in self.trials:
                self.progress.begin(trial)
                self._trial(trial, copy)
            state = "complete"
        finally:
            self._write_manifest(state)
            summary = self._summary(time.monotonic() - began)
            self.directory.write_json("run.json", {**summary, **self._circumstances()})
            self.directory.release()
        return summary

    def _begin(self) -> Path:
        """What stands in the directory before the first trial; nothing is left if there is no room for it."""
        try:
            self.directory.reserve()
            copy = self.directory.keep_experiment(self.file)
            self._write_manifest("running")
        except OSError as error:
            self.directory.remove()
            raise UserError(f"{self.directory.path}: {in_words(error)}") from error
        return copy

    def _trial(self, trial: int, file: Path) -> None:
        """Also of a trial that is interrupted it is known how far it came."""
        program = self.versions["swarm-runtime"]
        identity = RunIdentity.of(self.experiment, trial, self.run_id, program)
        plan = TrialPlan(identity, file, self.directory.output(trial))
        with self.environment(plan) as environment:
            reporter = environment.reporter
            *before, log = self.directory.logs(trial)
            earlier = earlier_progress(before)
            conductor = Conductor(self.experiment, identity, reporter, environment.carrier, earlier)
            about = metadata(self.experiment, file, identity, self.versions, self.directory.part)
            recorder = Recorder(log, about)
            health, views = Health(reporter), Views(self.experiment)
            played = Trial(environment, conductor, recorder, health, views, self.progress.show)
            try:
                played.run()
            finally:
                self.results.append(played.result())

    def _summary(self, wall_s: float) -> dict[str, Any]:
        logs = [log for trial in self.trials for log in self.directory.logs(trial)]
        logs = [log for log in logs if log.exists()]
        sim_s = sum(result.sim_s for result in self.results)
        return {
            "run": str(self.directory.path),
            "run_id": self.run_id,
            "log": [str(log) for log in logs],
            "digest": digest(logs),
            "moves": sum(result.moves for result in self.results),
            "sim_s": round(sim_s, 3),
            "wall_s": round(wall_s, 3),
            "real_time_factor": round(sim_s / wall_s, 2),
        }

    def _circumstances(self) -> dict[str, Any]:
        """What differs between two repetitions of a run."""
        return {
            "ended": datetime.now(UTC).isoformat(),
            "host": socket.gethostname(),
            "command": sys.argv,
            "trials": [asdict(result) for result in self.results],
        }

    def _write_manifest(self, state: str) -> None:
        """Conditions x trials x seeds, one record each."""
        run = self.experiment.run
        complete = {number for number, result in enumerate(self.results) if result.complete}
        records = [
            {
                "condition": robot.group,
                "robot": robot.id,
                "role": robot.role.value,
                "trial": trial,
                "seed": run.seed,
                "log": self.directory.logs(trial)[0].name,
                "state": "complete" if number in complete else state,
            }
            for number, trial in enumerate(self.trials)
            for robot in self.experiment.robot
        ]
        about = {"name": run.name, "run_id": self.run_id, "moves": run.moves}
        self.directory.write_json(MANIFEST, {**about, "trials": records})
