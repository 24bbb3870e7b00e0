"""A run: its trials one after the other, each in an environment of its own."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from functools import partial
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
from server.recording.latched import LatchedState
from server.recording.provenance import metadata, versions
from server.recording.recorder import digest
from server.recording.trial_recorder import TrialRecorder
from server.run_directory import MANIFEST, RunDirectory
from server.trial import Trial, TrialResult
from swarm.config.experiment import Experiment
from swarm.errors import UserError, in_words
from swarm.runtime.emergency_latch import EmergencyLatch
from swarm.runtime.identity import RunIdentity


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
    simulation: Simulation | None = None
    """How it is simulated; None on the robots of a laboratory."""
    results: dict[int, TrialResult] = field(default_factory=dict)
    """Of the trials so far; those that an earlier server completed are not repeated."""
    versions: dict[str, str] = field(default_factory=versions)

    def run(self) -> dict[str, Any]:
        """All trials; the run's directory is complete after each of them."""
        with self.directory.held():
            return self._held()

    def _held(self) -> dict[str, Any]:
        began = time.monotonic()
        copy = self._begin()
        to_do = [trial for trial in self.trials if trial not in self.results]
        state = "interrupted"
        try:
            for trial in to_do:
                self.progress.begin(trial)
                self._trial(trial, copy)
                self._write_manifest("running")
                if self.results[trial].stopped:
                    state = "stopped"
                    break
            else:
                state = "complete"
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
            copy = self.directory.keep_experiment(self.file)
            self.directory.close_logs()
            self._write_manifest("running")
        except OSError as error:
            self.directory.remove()
            raise UserError(f"{self.directory.path}: {in_words(error)}") from error
        return copy

    def _trial(self, trial: int, file: Path) -> None:
        """Also of a trial that is interrupted it is known how far it came.

        On robots a trial goes on from there; a simulated one begins again, and comes to the same.
        """
        if self.simulation:
            self.directory.set_aside(trial)
        program = self.versions["swarm-runtime"]
        identity = RunIdentity.of(self.experiment, trial, self.run_id, program)
        logs, latched = self.directory.logs(trial), LatchedState(self.experiment)
        latched.take_up(logs)
        plan = TrialPlan(identity, file, self.directory.output(trial), latched.last)
        with self.environment(plan) as environment:
            played = self._assembled(environment, identity, file, latched)
            try:
                with self._reached(environment):
                    played.run()
            finally:
                self.results[trial] = played.result()

    def _assembled(
        self, environment: TrialEnvironment, identity: RunIdentity, file: Path, latched: LatchedState
    ) -> Trial:
        """A trial, put together from its parts; it goes on from what earlier servers recorded of it."""
        experiment, reporter, prompts = self.experiment, environment.reporter, environment.prompts
        trial, hub = identity.trial, environment.hub
        board = StatusBoard(experiment, identity, prompts, lambda: hub.missing)
        latch = EmergencyLatch(self.directory.emergency if environment.session else None)
        robots = [robot.id for robot in experiment.robot]
        control = RunControl(robots, reporter, latch, prompts, board.pose_of)
        carrier, earlier = environment.carrier, earlier_progress(self.directory.logs(trial))
        conductor = Conductor(experiment, identity, reporter, carrier, control, earlier)
        desk = None
        if environment.session:
            desk = Desk(environment.session, control, board, prompts, conductor, reporter)
        recorder = TrialRecorder(
            partial(self.directory.log, trial),
            partial(metadata, experiment, file, identity, self.versions),
            experiment.log,
            latched,
            self.directory.next_part(trial),
            recovered=lambda: hub.recovered,
        )
        health, views = Health(reporter), Views(experiment)
        return Trial(environment, conductor, recorder, health, views, self.progress.show, desk)

    def _reached(self, environment: TrialEnvironment) -> AbstractContextManager[None]:
        """Where people find a run that they can steer."""
        session = environment.session
        return self.directory.reached_at(session.endpoint) if session else nullcontext()

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
        about = {"name": run.name, "run_id": self.run_id, "moves": run.moves}
        simulation = asdict(self.simulation) if self.simulation else None
        content = {**about, "simulation": simulation, "trials": records, "results": complete}
        self.directory.write_json(MANIFEST, content)
