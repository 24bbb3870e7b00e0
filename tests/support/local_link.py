"""A link within one process: what is published goes into the feeds at once."""

from __future__ import annotations

from typing import Any, TypeVar

from google.protobuf.message import Message

from swarm.messages.header import Header
from swarm.messages.topics import Topic
from swarm.runtime.lockstep import key_matches
from swarm.runtime.node import Sequencer, Step
from swarm.runtime.subscription import Feed

M = TypeVar("M", bound=Message)


class LocalLink:
    """Everything that was published, in order, and the feeds that hear it."""

    def __init__(self) -> None:
        self.t_ns = 0
        self.published: list[tuple[str, Any]] = []
        self.keys_received: set[str] = set()
        self._feeds: list[tuple[str, Feed[Any]]] = []
        self._sequencer = Sequencer()

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Feed[M]:
        feed = Feed(topic)
        self._feeds.append((topic.key(robot), feed))
        return feed

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        key = topic.key(robot)
        self.published.append((key, message))
        header = Header(1, self._sequencer.following(key), self.t_ns)
        for expression, feed in self._feeds:
            if key_matches(expression, key):
                feed.put(key, header, message.SerializeToString())

    def run(self, step: Step) -> None:
        while True:
            step(self.t_ns)
