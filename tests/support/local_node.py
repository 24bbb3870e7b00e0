"""A link within one process: what is published goes into the feeds at once."""

from __future__ import annotations

from typing import Any, TypeVar

from google.protobuf.message import Message

from swarm.messages.header import Header
from swarm.messages.topics import Topic
from swarm.runtime.lockstep import key_matches
from swarm.runtime.node import Sequencer, Step
from swarm.runtime.receipts import Receipts
from swarm.runtime.subscription import Subscription

M = TypeVar("M", bound=Message)


class LocalNode:
    """Everything that was published, in order, and the feeds that hear it."""

    run_id = ""

    def __init__(self) -> None:
        self.t_ns = 0
        self.behind_s = 0.0
        self.losses = 0
        self.published: list[tuple[str, Any]] = []
        self.received = Receipts()
        self._subscriptions: list[tuple[str, Subscription[Any]]] = []
        self._sequencer = Sequencer()

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        subscription = Subscription(topic)
        self._subscriptions.append((topic.key(robot), subscription))
        return subscription

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        key = topic.key(robot)
        self.published.append((key, message))
        header = Header(1, self._sequencer.following(key), self.t_ns)
        for expression, subscription in self._subscriptions:
            if key_matches(expression, key):
                subscription.put(key, header, message.SerializeToString())

    def offset_ns(self, topic: Topic[Any], robot: str = "") -> int:  # noqa: ARG002
        return 0

    def lag_s(self) -> float:
        return self.behind_s

    def run(self, step: Step) -> None:
        while True:
            step(self.t_ns)
