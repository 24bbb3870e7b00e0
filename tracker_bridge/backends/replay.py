"""Plays a recording: a tracking system's own file, or a run's log, at the pace at which it was made."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from swarm.config.experiment import Experiment
from swarm.errors import UserError
from tracker_bridge.backends.bodies import Body, Roster
from tracker_bridge.backends.interface import Backend, Setup, TrackedPose, TrackingSystem
from tracker_bridge.recordings.files import read_recording
from tracker_bridge.recordings.log import is_log, read_log

Seen = tuple[int, Callable[[int], Iterable[TrackedPose]]]
"""A moment of the recording, by the recording's time, and what was seen then, given the run's time."""


class Replay:
    """The first call of `poses` is the recording's first moment."""

    def __init__(self, moments: list[Seen]) -> None:
        self._moments = sorted(moments, key=lambda moment: moment[0])
        self._next = 0
        self._shift_ns: int | None = None

    @property
    def is_over(self) -> bool:
        return self._next == len(self._moments)

    def poses(self, t_ns: int) -> list[TrackedPose]:
        if self._shift_ns is None:
            self._shift_ns = t_ns - self._moments[0][0]
        tracked: list[TrackedPose] = []
        while not self.is_over and self._moments[self._next][0] + self._shift_ns <= t_ns:
            source_ns, seen = self._moments[self._next]
            tracked += seen(source_ns + self._shift_ns)
            self._next += 1
        return tracked


def replay(experiment: Experiment, path: Path) -> Replay:
    """The recording in a file; UserError if it cannot be read."""
    if is_log(path):
        return Replay([(tracked.captured_t_ns, _shifted(tracked)) for tracked in read_log(path)])
    recording = read_recording(path)
    roster = Roster(experiment, recording.unit_m)
    return Replay(
        [(moment.t_ns, _placed(roster, moment.bodies, moment.t_ns)) for moment in recording.moments]
    )


def _shifted(tracked: TrackedPose) -> Callable[[int], Iterable[TrackedPose]]:
    return lambda t_ns: [tracked._replace(captured_t_ns=t_ns, received_t_ns=t_ns)]


def _placed(roster: Roster, bodies: list[Body], source_ns: int) -> Callable[[int], Iterable[TrackedPose]]:
    return lambda t_ns: roster.tracked(bodies, t_ns, t_ns, source_ns)


@contextmanager
def _opened(setup: Setup) -> Iterator[Backend]:
    file = setup.experiment.tracker.file
    if not file:
        raise UserError('[tracker] backend is "replay", but no file is given')
    yield replay(setup.experiment, Path(file))


SYSTEM = TrackingSystem(_opened)
