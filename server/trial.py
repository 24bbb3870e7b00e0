"""One trial from its first to its last message."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from google.protobuf.message import Message

from server.conductor.conductor import Conductor
from server.control.desk import Desk
from server.hubs.hub import Batch
from server.processes.environment import TrialEnvironment
from server.recording.foxglove_views import Views
from server.recording.health import Health
from server.recording.trial_recorder import TrialRecorder
from swarm.clock import unix_clock
from swarm.errors import RunFailedError
from swarm.logs.ending import COMPLETE
from swarm.messages import swarm_pb2 as pb

SIGNALLED = 128
"""A process that leaves on a signal has this code and the signal's number."""
LOOK_FOR_ROOM_S = 1.0
"""A person frees some space; who waits need not be quicker."""
BATCHES_AFTER_THE_END = 3
"""The end reaches the robots two exchanges later; one more brings their last words."""


@dataclass(frozen=True)
class TrialResult:
    """What a trial came to."""

    complete: bool
    moves: int
    best_paths: dict[str, int]
    """The last that each learner reported; none of who reported none."""
    sim_s: float
    messages: int
    bad_messages: int
    left_out: dict[str, dict[str, int]]
    """By reason, keys with the number of their messages that were not recorded."""
    disk_error: str
    slowest_keys: dict[str, float]
    stopped: str
    """Who ended the trial before its time, and why; empty if nobody did."""


class Onlooker(Protocol):
    """Who gets what the log gets, while the trial goes on."""

    def write(self, batch: Batch) -> None:
        """What was received."""

    def write_view(self, topic: str, message: Message, t_ns: int) -> None:
        """What the server made for viewers."""


class Trial:
    """Moves messages from the hub to the conductor, the health check and the log."""

    def __init__(
        self,
        environment: TrialEnvironment,
        conductor: Conductor,
        recorder: TrialRecorder,
        health: Health,
        views: Views,
        show: Callable[[Conductor, float], None],
        desk: Desk | None = None,
        onlookers: Sequence[Onlooker] = (),
    ) -> None:
        self._hub = environment.hub
        self._environment = environment
        self._conductor = conductor
        self._recorder = recorder
        self._health = health
        self._views = views
        self._show = show
        self._desk = desk
        self._recorded_by = (recorder, *onlookers)
        self._complete = False
        self._batches = 0
        self._began_ns: int | None = None
        self._t_ns = 0

    def run(self) -> None:
        """Until every learner has made its moves, or an operator stops it. The log is closed in any case."""
        try:
            self._hub.start(self._wait)
            self._hub.advance()
            while not self._conductor.ended:
                self._step()
            for _ in range(BATCHES_AFTER_THE_END):
                self._step()
            self._recorder.write(self._hub.finish())
            stopped = self._conductor.stopped
            self._end("stopped" if stopped else COMPLETE, stopped)
            self._complete = not stopped
        except BaseException as error:
            self._note_end(error)
            raise
        finally:
            self._recorder.close()

    def result(self) -> TrialResult:
        """What the trial has come to so far."""
        return TrialResult(
            complete=self._complete,
            moves=sum(self._conductor.moves.values()),
            best_paths={robot: length for robot, length in self._conductor.best_path.items() if length},
            sim_s=(self._t_ns - (self._began_ns or 0)) / 1e9,
            messages=self._recorder.messages,
            bad_messages=self._conductor.bad_messages,
            left_out={reason: dict(keys) for reason, keys in vars(self._recorder.left_out).items()},
            disk_error=self._recorder.disk_error,
            slowest_keys=self._health.lowest_share,
            stopped=self._conductor.stopped,
        )

    def _step(self) -> None:
        """The processes already work on the next tick while this one is looked at and recorded."""
        batch = self._hub.gather()
        self._hub.advance()
        if self._desk:
            self._desk.step(batch)
        self._conductor.step(batch)
        for recorded_by in self._recorded_by:
            recorded_by.write(batch)
        for topic, view in self._views.of(batch):
            for recorded_by in self._recorded_by:
                recorded_by.write_view(topic, view, batch.t_ns)
        self._health.step(batch)
        self._began_ns = batch.t_ns if self._began_ns is None else self._began_ns
        self._t_ns = batch.t_ns
        self._batches += 1
        if self._batches % self._environment.batches_between_flushes == 0:
            self._look_for_standing(batch.t_ns)
            self._recorder.flush()
            self._await_room()
            self._show(self._conductor, (self._t_ns - self._began_ns) / 1e9)

    def _wait(self) -> None:
        """Serve people while the robots are not all there; who stops the run ends the waiting, too."""
        if self._desk:
            self._desk.serve()
        if self._conductor.stopped:
            raise RunFailedError(f"stopped by {self._conductor.stopped} before it began")

    def _look_for_standing(self, t_ns: int) -> None:
        """People can help a robot that stands."""
        if self._environment.waits_for_people:
            for line in self._conductor.newly_standing(t_ns):
                self._environment.warn(line)
        else:
            self._conductor.check_progress(t_ns)

    def _await_room(self) -> None:
        """While the disk has no room the trial pauses: robots stand after their moves, a lockstep stops."""
        lack = self._recorder.waits_for
        if bool(lack) == self._conductor.lacks_room:
            return
        self._tell("paused" if lack else "goes on", lack or "the disk has room again")
        if self._environment.session is None:
            for _ in unix_clock().ticks(LOOK_FOR_ROOM_S):
                self._recorder.flush()
                if not self._recorder.waits_for:
                    break
            self._tell("goes on", "the disk has room again")
        else:
            self._conductor.lacks_room = bool(lack)

    def _tell(self, name: str, text: str) -> None:
        self._environment.warn(f"{name}: {text}")
        self._environment.reporter.event(name, text, pb.Event.WARNING)

    def _note_end(self, error: BaseException) -> None:
        """The reason is the log's last message, and stands in its last record."""
        text = _reason(error)
        self._environment.reporter.event("interrupted", text[:500], pb.Event.ERROR)
        self._recorder.write(self._hub.unsent())
        self._end("interrupted", text[:500])

    def _end(self, state: str, reason: str) -> None:
        self._recorder.end(state, reason, self._hub.accounts(), self._hub.receipts())


def _reason(error: BaseException) -> str:
    """In words, also for a process that leaves by itself or on a signal."""
    if isinstance(error, SystemExit) and isinstance(error.code, int) and error.code > SIGNALLED:
        return f"the server was ended by {signal.Signals(error.code - SIGNALLED).name}"
    return str(error) or type(error).__name__
