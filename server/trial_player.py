"""Plays a run's trials, one here or several at a time in processes of their own: the logs are the same.

A trial depends on nothing but the experiment and its number, so it does not matter who plays it, nor when.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from server.conductor.conductor import Conductor
from server.conductor.earlier import earlier_progress
from server.conductor.run_control import RunControl
from server.control.desk import Desk
from server.control.status_board import StatusBoard
from server.processes.cpu_affinity import keeping_to_share
from server.processes.environment import Environment, TrialEnvironment, TrialPlan, simulated
from server.recording.foxglove_views import Views
from server.recording.health import Health
from server.recording.latched import LatchedState
from server.recording.provenance import metadata
from server.recording.trial_recorder import TrialRecorder
from server.run_directory import RunDirectory
from server.trial import Onlooker, Trial, TrialResult
from swarm.config.experiment import Experiment
from swarm.errors import RunFailedError
from swarm.parallel import workers
from swarm.runtime.emergency_latch import EmergencyLatch
from swarm.runtime.identity import RunIdentity
from swarm.signals import leave_on_signals

Show = Callable[[Conductor, float], None]
Note = Callable[[int, TrialResult], object]


@dataclass(frozen=True)
class TrialPlayer:
    """What all trials of a run have in common; it can be sent to another process."""

    experiment: Experiment
    file: Path
    """The run's own, which its processes are given too."""
    changes: Sequence[str]
    directory: RunDirectory
    versions: dict[str, str]
    run_id: str = ""
    onlookers: Sequence[Onlooker] = ()
    """Of trials that are played in this process; they cannot be sent to another."""
    is_repeatable: bool = False
    """Whether a trial that was interrupted begins again, and comes to the same; on robots it goes on."""

    def play(self, trial: int, environment: Environment, show: Show, note: Note) -> None:
        """One trial; `note` is told what it came to, also if it is interrupted."""
        identity = RunIdentity.of(self.experiment, trial, self.run_id, self.versions["swarm-runtime"])
        if self.is_repeatable:
            self.directory.set_aside(trial)
        latched = LatchedState(self.experiment)
        latched.take_up(self.directory.logs(trial))
        plan = TrialPlan(identity, self.file, self.directory.output(trial), latched.last)
        with environment(plan) as played_on:
            played = self._assembled(played_on, identity, latched, show)
            try:
                with self._reached(played_on):
                    played.run()
            finally:
                note(trial, played.result())

    def _assembled(
        self, environment: TrialEnvironment, identity: RunIdentity, latched: LatchedState, show: Show
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
            partial(metadata, experiment, self.file, self.changes, identity, self.versions),
            experiment.log,
            latched,
            self.directory.next_part(trial),
            recovered=lambda: hub.recovered,
        )
        health, views = Health(reporter), Views(experiment)
        return Trial(environment, conductor, recorder, health, views, show, desk, self.onlookers)

    def _reached(self, environment: TrialEnvironment) -> AbstractContextManager[None]:
        """Where people find a run that they can steer."""
        session = environment.session
        return self.directory.reached_at(session.endpoint) if session else nullcontext()


def play_together(player: TrialPlayer, trials: Sequence[int], scheduler: str, jobs: int, note: Note) -> None:
    """`jobs` trials at a time, in lockstep, where `swarm.parallel` knows workers; `note` is told of each."""
    player = replace(
        player,
        file=player.file.absolute(),
        directory=replace(player.directory, path=player.directory.path.absolute()),
    )
    with workers(scheduler, jobs) as pool, _ending_workers():
        calls = ((player, trial, number, jobs) for number, trial in enumerate(trials))
        for trial, result in pool.each(_play_apart, calls):
            note(trial, result)


def _play_apart(player: TrialPlayer, trial: int, number: int, jobs: int) -> tuple[int, TrialResult]:
    """In a worker: a signal ends the trial in order, as it would in the server's own process."""
    if threading.current_thread() is threading.main_thread():
        leave_on_signals()
    if not player.file.exists():
        raise RunFailedError(
            f"{player.file}: a worker does not see the run's directory; let all share a disk"
        )
    results: list[tuple[int, TrialResult]] = []
    environment = partial(simulated, player.experiment, None, _warn)
    try:
        with keeping_to_share(number, jobs):
            player.play(trial, environment, lambda *_: None, lambda *result: results.append(result))
    except SystemExit as told:
        # Not the trial alone is over: a pool hands the next one to a worker that goes on.
        os._exit(int(told.code or 0))
    return results[0]


def _warn(text: str) -> None:
    print(f"warning: {text}", file=sys.stderr, flush=True)


@contextmanager
def _ending_workers() -> Iterator[None]:
    """Whatever ends this block early ends the trials in the worker processes of this machine too."""
    try:
        yield
    except BaseException:
        for worker in multiprocessing.active_children():
            with suppress(ProcessLookupError):
                os.kill(worker.pid or 0, signal.SIGTERM)
        raise
