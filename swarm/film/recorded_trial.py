"""What a film needs of a trial's logs: where everybody was, and what a robot did, learnt and saw, by time."""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment
from swarm.errors import UserError, nearest
from swarm.geometry import Pose
from swarm.logs.identity import LogIdentity, identify
from swarm.logs.reader import LogReader, Part
from swarm.logs.trial_logs import by_trial, logs_in
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic
from swarm.messages.validation import BadMessageError, decode

READ = (
    topics.TRUTH,
    topics.POSE,
    topics.MOVE,
    topics.BEST_PATH,
    topics.PATH,
    topics.REPLAY,
    topics.VISIT,
    topics.OBSERVATION,
)

Timed = list[tuple[int, Any]]
"""Messages with the run's time in ns, in order."""


@dataclass
class RecordedTrial:
    """A trial's messages by topic and robot."""

    identity: LogIdentity
    experiment: Experiment
    said: dict[tuple[Topic[Any], str], Timed] = field(default_factory=lambda: defaultdict(list))

    def of(self, topic: Topic[Any], robot: str) -> Timed:
        return self.said.get((topic, robot), [])

    def newest(self, topic: Topic[Any], robot: str, t_ns: int) -> Any:
        """The last message by then; None before the first."""
        said = self.of(topic, robot)
        place = bisect_right(said, t_ns, key=lambda each: each[0])
        return said[place - 1][1] if place else None

    def pose(self, robot: str, t_ns: int) -> Pose | None:
        """Where it really was in a simulation; else where the tracker saw it."""
        for topic in (topics.TRUTH, topics.POSE):
            found = self.newest(topic, robot, t_ns)
            if found is not None:
                return Pose(found.x_m, found.y_m, found.theta_rad)
        return None

    @property
    def truths(self) -> dict[str, dict[int, pb.Truth]]:
        """Robot -> time -> where it really was."""
        return {robot: dict(said) for (topic, robot), said in self.said.items() if topic is topics.TRUTH}

    def looks(self, robot: str) -> list[pb.Look]:
        """Of all visits, in order."""
        return [look for _, observation in self.of(topics.OBSERVATION, robot) for look in observation.looks]

    def moves(self, robot: str) -> Timed:
        """A robot's moves. One that started again went on from an earlier move: what it knew of those after
        that is gone.
        """
        kept: Timed = []
        for t_ns, move in self.of(topics.MOVE, robot):
            while kept and kept[-1][1].number >= move.number:
                kept.pop()
            kept.append((t_ns, move))
        return kept


def read_trial(run: Path, trial: int) -> RecordedTrial:
    """One trial of a run directory, or that of a log; UserError if it is not there."""
    parts = _logs_of(run, trial)
    said: dict[tuple[Topic[Any], str], Timed] = defaultdict(list)
    experiments = [_read(part, said) for part in parts]
    for messages in said.values():
        messages.sort(key=lambda each: each[0])
    identity = parts[0]
    experiment = Experiment.of_log(identity.name, experiments[0], {})
    return RecordedTrial(identity, experiment.changed(seed=identity.seed, moves=identity.moves), said)


def _logs_of(run: Path, trial: int) -> Sequence[LogIdentity]:
    if not run.is_dir():
        return [identify(run)]
    found = {parts[0].trial: parts for parts in by_trial(logs_in(run, []))}
    if trial not in found:
        raise UserError(f"{run}: has no trial {trial}; {nearest(str(trial), map(str, found))}")
    return found[trial]


def _read(log: LogIdentity, said: dict[tuple[Topic[Any], str], Timed]) -> str:
    """Take in one log; returns its experiment."""
    reader = LogReader(log.path, lambda channel: channel.topic in READ)
    for part in reader.parts():
        if part.channel.topic in READ and part.payloads:
            said[part.channel.topic, part.channel.publisher] += _decoded(part)
    return reader.metadata.get("experiment", {}).get("toml", "")


def _decoded(part: Part) -> Iterator[tuple[int, Any]]:
    assert part.channel.topic is not None
    for t_ns, payload in zip(part.publish_t_ns, part.payloads, strict=True):
        try:
            yield int(t_ns), decode(part.channel.topic.message, payload)
        except BadMessageError:
            continue
