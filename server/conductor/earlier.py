"""How far a trial was when its server ended, by the logs that the server left."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.logs.reader import LogChannel, LogError, LogReader, Part
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.validation import BadMessageError, decode


@dataclass
class EarlierProgress:
    """What one robot had done: moves, journeys that ended before the last one, paths copied, visits ordered,
    and visits that are over.
    """

    moves: int = 0
    tracks: int = 0
    copied_paths: int = 0
    visits: int = 0
    visits_over: int = 0

    def heard(self, message: Any) -> None:
        """Take in a message by or to the robot."""
        if isinstance(message, pb.Move):
            self.moves = max(self.moves, message.number)
            self.tracks = max(self.tracks, message.track - 1)
        elif isinstance(message, pb.PathRemembered):
            self.copied_paths += message.visit > 0
        elif isinstance(message, pb.Order):
            self.visits = max(self.visits, message.visit)
        elif message.phase == pb.Visit.DONE:
            self.visits_over = max(self.visits_over, message.visit)


HEARD = (topics.MOVE, topics.PATH, topics.ORDER, topics.VISIT)


def earlier_progress(logs: Sequence[Path]) -> dict[str, EarlierProgress]:
    """By robot, from logs in the order in which they were recorded."""
    found: dict[str, EarlierProgress] = {}
    for log in logs:
        with suppress(LogError):  # A server that was killed in its first moment left nothing to read.
            for part in LogReader(log, _is_heard).parts():
                _take_in(part, found.setdefault(part.channel.publisher, EarlierProgress()))
    return found


def _is_heard(channel: LogChannel) -> bool:
    return channel.topic in HEARD


def _take_in(part: Part, progress: EarlierProgress) -> None:
    for payload in part.payloads:
        assert part.channel.topic is not None
        with suppress(BadMessageError):
            progress.heard(decode(part.channel.topic.message, payload))
