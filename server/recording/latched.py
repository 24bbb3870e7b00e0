"""What a log that goes on from others repeats of them, so that it can be read alone."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment
from swarm.learning.q_table import QTable
from swarm.logs.ending import BEFORE, Sender, numbers_record
from swarm.logs.reader import LogError, LogReader
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic, topic_of
from swarm.messages.validation import BadMessageError, decode

LATCHED = "latched"
"""The metadata record: of each robot, as JSON, its moves, journeys, remembered paths and Q-table."""
HEARD: tuple[Topic[Any], ...] = (topics.MOVE, topics.PATH)


@dataclass
class LatchedRobot:
    """What a robot has learnt so far, by what it says of every move."""

    q: list[list[float]]
    """The value of every move in every cell."""
    moves: int = 0
    tracks: int = 0
    paths: dict[int, list[int]] = field(default_factory=dict)
    """The moves of each remembered path, by its number."""

    def heard(self, message: Any) -> None:
        """Take in a move or a path; a robot that begins anew knows nothing."""
        if isinstance(message, pb.PathRemembered):
            self.paths[message.path] = list(message.moves)
            return
        if message.number == 1:
            self.q = QTable(len(self.q)).values
        self.moves, self.tracks = message.number, message.track
        with suppress(IndexError):  # A cell that this experiment has not is not learnt about.
            self.q[message.state][message.action] = message.q_value


class LatchedState:
    """Follows a trial from its messages, and is written at the head of the trial's next log."""

    def __init__(self, experiment: Experiment) -> None:
        self.last: dict[Sender, int] = {}
        """The last number of each sender in the logs that are finished."""
        self._robots = {
            robot.id: LatchedRobot(QTable(experiment.compartment(robot).grid.states).values)
            for robot in experiment.learners
        }
        self._heard: dict[str, tuple[Topic[Any], LatchedRobot] | None] = {}

    def heard(self, key: str, payload: bytes) -> None:
        """Take in what was recorded."""
        if key not in self._heard:
            self._heard[key] = self._of(key)
        found = self._heard[key]
        if found:
            with suppress(BadMessageError):
                found[1].heard(decode(found[0].message, payload))

    def finished(self, last: Mapping[Sender, int]) -> None:
        """A log is finished; `last` has the last number of each sender in it."""
        for sender, number in last.items():
            self.last[sender] = max(number, self.last.get(sender, 0))

    def records(self) -> dict[str, dict[str, str]]:
        """The metadata of a log that goes on."""
        robots = {name: json.dumps(vars(robot)) for name, robot in self._robots.items()}
        return {BEFORE: numbers_record(self.last), LATCHED: robots}

    def take_up(self, logs: Iterable[Path]) -> None:
        """Follow the trial up to here by the logs that earlier servers left."""
        for log in logs:
            with suppress(LogError):  # A server that was killed in its first moment left nothing to read.
                self._read(log)

    def _read(self, log: Path) -> None:
        last: dict[Sender, int] = {}
        for part in LogReader(log, lambda channel: channel.topic in HEARD).parts():
            sender = (part.channel.key, part.channel.epoch)
            if part.channel.epoch:
                last[sender] = max(int(part.sequence.max()), last.get(sender, 0))
            for payload in part.payloads:
                self.heard(part.channel.key, payload)
        self.finished(last)

    def _of(self, key: str) -> tuple[Topic[Any], LatchedRobot] | None:
        found = topic_of(key)
        if found is None or found[0] not in HEARD or found[1] not in self._robots:
            return None
        return found[0], self._robots[found[1]]
