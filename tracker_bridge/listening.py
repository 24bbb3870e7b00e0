"""Listens to an experiment's tracking system without a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from statistics import median

from swarm.clock import NS_PER_S, WallClock
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.geometry import Pose
from tracker_bridge.backends.datagrams import Arrivals, Receiving
from tracker_bridge.backends.interface import POLL_S, Backend, Setup, TrackedPose
from tracker_bridge.backends.registry import system_named
from tracker_bridge.protocols.cursor import Vector
from tracker_bridge.survey import Report, Survey

LONGEST_TRACK = 20 * 600
"""Ten minutes at the 20 poses a second that a survey keeps."""


class Listener:
    """A backend that is asked at every tick of a clock."""

    def __init__(self, experiment: Experiment, backend: Backend, clock: WallClock, poll_s: float) -> None:
        self._experiment = experiment
        self._backend = backend
        self._clock = clock
        self._poll_s = poll_s

    def poses(self, seconds: float) -> Iterator[list[TrackedPose]]:
        """What arrives at each tick, for so long."""
        end_ns = self._clock.now_ns() + round(seconds * NS_PER_S)
        for t_ns in self._clock.ticks(self._poll_s):
            yield self._backend.poses(t_ns)
            if t_ns >= end_ns:
                return

    def survey(self, seconds: float) -> Survey:
        """What came while listening for so long."""
        survey = Survey(self._experiment)
        for poses in self.poses(seconds):
            survey.take(poses, self._clock.now_ns())
        return survey

    def watched(self, every_s: float) -> Iterator[tuple[Report, dict[str, list[Pose]]]]:
        """A report each time, and each robot's track of the last minutes."""
        tracks: dict[str, list[Pose]] = {}
        while True:
            survey = self.survey(every_s)
            for robot, track in survey.tracks.items():
                tracks[robot] = (tracks.get(robot, []) + track)[-LONGEST_TRACK:]
            yield survey.report(every_s, self.arrivals), tracks

    @property
    def arrivals(self) -> Arrivals:
        """The datagrams since the beginning; none of a backend that receives no datagrams."""
        return self._backend.arrivals if isinstance(self._backend, Receiving) else Arrivals()


@contextmanager
def listening(experiment: Experiment, clock: WallClock) -> Iterator[Listener]:
    """A listener to the system that the experiment names; UserError if it lives only within a run."""
    system = system_named(experiment.tracker.backend)
    with system.open(Setup(experiment, None)) as backend:
        yield Listener(experiment, backend, clock, system.poll_s or POLL_S)


def seen_at(experiment: Experiment, body: str, seconds: float, clock: WallClock) -> Vector:
    """Where a body stands by the system's own axes and unit; UserError if it is not seen.

    Without a name, any body that is seen, if only one is.
    """
    tracker = replace(experiment.tracker, axes="x y z", unit_m=1.0, origin_m=(0.0, 0.0), turn_rad=0.0)
    with listening(replace(experiment, tracker=tracker), clock) as listener:
        poses = [tracked for given in listener.poses(seconds) for tracked in given]
    names = {robot.body or robot.id: robot.id for robot in experiment.robot}
    wanted = names.get(body, body)
    found = [tracked for tracked in poses if wanted in ("", tracked.robot)]
    who = {tracked.robot for tracked in found}
    if len(who) != 1:
        raise UserError(f"seen: {', '.join(sorted(who)) or 'nobody'}; exactly one body is needed, see --body")
    x, y = (median(part) for part in zip(*((each.pose.x_m, each.pose.y_m) for each in found), strict=True))
    return x, y, median(tracked.height_m or 0.0 for tracked in found)
