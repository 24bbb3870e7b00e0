"""One run's history. Whatever tells of the run, a log or the wire, fills it; whoever looks asks it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from threading import Lock
from typing import Any, NamedTuple

from google.protobuf.message import Message

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from swarm.console.robot_history import CopyErrorAt, ObservationAt, RobotHistory
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Item
from swarm.messages.topics import Topic, topic_of
from swarm.messages.validation import BadMessageError, decode

MOST_EVENTS = 20_000
"""Kept of one run; ten hours of the demonstration have 500."""


Take = Callable[[float, RobotHistory, Any], None]
_TAKE: Mapping[Topic[Any], Take] = {
    topics.MOVE: lambda t_s, robot, move: robot.learning.add_move(t_s, move),
    topics.BEST_PATH: lambda t_s, robot, best: robot.learning.add_best_path(t_s, best),
    topics.PATH: lambda t_s, robot, path: robot.learning.add_path(t_s, path),
    topics.REPLAY: lambda t_s, robot, replay: robot.learning.add_replay(t_s, replay),
    topics.STATUS: lambda t_s, robot, status: robot.add_status(t_s, status),
    topics.VISIT: lambda t_s, robot, visit: robot.add_visit(t_s, visit),
    topics.OBSERVATION: lambda t_s, robot, seen: robot.observations.append(ObservationAt(t_s, seen)),
    topics.COPY_ERROR: lambda t_s, robot, error: robot.copy_errors.append(CopyErrorAt(t_s, error)),
}
SHOWN: frozenset[Topic[Any]] = frozenset(
    [*_TAKE, topics.POSE, topics.RUN_STATE, topics.EVENT, topics.TRACKER_EVENT, topics.SERVER_EVENT]
)
"""What a console needs of a run. Wheel commands and true poses, most of a log, it does not."""


class EventAt(NamedTuple):
    """Something that a person should know."""

    t_s: float
    level: str
    who: str
    name: str
    text: str


class PhaseAt(NamedTuple):
    """A phase of the run that begins."""

    t_s: float
    phase: str
    trial: int


class About(NamedTuple):
    """Which trial of which run, and where it is heard of."""

    source: str
    trial: int
    commit: str = "unknown"
    run_id: str = ""


class RunHistory:
    """What was said in one trial, in seconds since its first message.

    It is filled on one thread and read on another: hold `lock` for either.
    """

    def __init__(self, experiment: Experiment, about: About) -> None:
        self.experiment = experiment
        self.about = about
        self.lock = Lock()
        self.robots = {robot.id: RobotHistory(experiment, robot) for robot in experiment.robot}
        self.events: list[EventAt] = []
        self.phases: list[PhaseAt] = []
        self.end_s = 0.0
        self.messages = 0
        """That were taken in so far: whether there is anything new."""
        self.bad_messages = 0
        self._began_ns: int | None = None

    @property
    def began_ns(self) -> int:
        """The run's time of the first message."""
        return self._began_ns or 0

    def time_of_move(self, number: int) -> float | None:
        """When the last of the learners had made so many moves; None if one has not yet."""
        times = [self.robots[robot.id].learning.time_of_move(number) for robot in self.experiment.learners]
        known = [t_s for t_s in times if t_s is not None]
        return max(known) if len(known) == len(times) else None

    def add(self, t_ns: int, item: Item) -> None:
        """Take in a message that was received at a time of the run; bad ones are counted."""
        found = topic_of(item.key)
        if found is None:
            return
        topic, name = found
        robot = self.robots.get(name)
        if topic not in SHOWN:
            return
        self.messages += 1
        if robot:
            robot.numbers[item.key].add(item.header)
        try:
            self._add(self._seconds(t_ns), topic, robot, decode(topic.message, item.payload), name)
        except BadMessageError:
            self.bad_messages += 1

    def _add(
        self, t_s: float, topic: Topic[Any], robot: RobotHistory | None, message: Message, name: str
    ) -> None:
        if isinstance(message, pb.RunState):
            self._add_phase(t_s, message)
        elif isinstance(message, pb.Event):
            self._add_event(t_s, message, name or topic.key().partition("/")[0])
        elif robot and isinstance(message, pb.Pose):
            robot.track.add(t_s, (message.captured_t_ns - self.began_ns) / NS_PER_S, message)
        elif robot:
            _TAKE[topic](t_s, robot, message)

    def _seconds(self, t_ns: int) -> float:
        """Time never goes back here, so that every list stays in order."""
        if self._began_ns is None:
            self._began_ns = t_ns
        self.end_s = max(self.end_s, (t_ns - self._began_ns) / NS_PER_S)
        return self.end_s

    def _add_phase(self, t_s: float, state: pb.RunState) -> None:
        phase = pb.RunState.Phase.Name(state.phase).lower()
        if not self.phases or self.phases[-1].phase != phase:
            self.phases.append(PhaseAt(t_s, phase, state.trial))

    def _add_event(self, t_s: float, event: pb.Event, who: str) -> None:
        if len(self.events) < MOST_EVENTS:
            level = pb.Event.Level.Name(event.level).lower()
            self.events.append(EventAt(t_s, level, who, event.name, event.text))
