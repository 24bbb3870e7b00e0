"""A run: its trials one after the other, each in an environment of its own."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from server.conductor.conductor import Conductor
from server.conductor.earlier import earlier_progress
from server.conductor.run_control import RunControl
from server.control.desk import Desk
from server.control.status_board import StatusBoard
from server.processes.environment import Environment, TrialEnvironment, TrialPlan
from server.progress import RunProgress
from server.recording.foxglove_views import Views
from server.recording.health import Health
from server.recording.provenance import metadata, versions
from server.recording.recorder import Recorder, digest
from server.run_directory import MANIFEST, RunDirectory
from server.trial import Trial, TrialResult
from swarm.config.experiment import Experiment
from swarm.errors import UserError, in_words
from swarm.runtime.emergency_latch import EmergencyLatch
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
                if self.results[-1].stopped:
                    state = "stopped"
                    break
            else:
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
            played = self._assembled(environment, identity, file)
            try:
                with self._reached(environment):
                    played.run()
            finally:
                self.results.append(played.result())

    def _assembled(self, environment: TrialEnvironment, identity: RunIdentity, file: Path) -> Trial:
        """A trial, put together from its parts."""
        experiment, reporter, prompts = self.experiment, environment.reporter, environment.prompts
        *before, log = self.directory.logs(identity.trial)
        board = StatusBoard(experiment, identity, prompts, lambda: environment.hub.missing)
        latch = EmergencyLatch(self.directory.emergency if environment.session else None)
        robots = [robot.id for robot in experiment.robot]
        control = RunControl(robots, reporter, latch, prompts, board.pose_of)
        carrier, earlier = environment.carrier, earlier_progress(before)
        conductor = Conductor(experiment, identity, reporter, carrier, control, earlier)
        desk = None
        if environment.session:
            desk = Desk(environment.session, control, board, prompts, conductor, reporter)
        about = metadata(experiment, file, identity, self.versions, self.directory.part)
        return Trial(
            environment,
            conductor,
            Recorder(log, about),
            Health(reporter),
            Views(experiment),
            self.progress.show,
            desk,
        )

    def _reached(self, environment: TrialEnvironment) -> AbstractContextManager[None]:
        """Where people find a run that they can steer."""
        session = environment.session
        return self.directory.reached_at(session.endpoint) if session else nullcontext()

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
