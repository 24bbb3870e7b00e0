"""What a process receives of one topic: decoded, checked, without duplicates, and counted when bad."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Generic, NamedTuple, TypeVar

from google.protobuf.message import Message

from swarm.messages.header import Header, Item
from swarm.messages.topics import Delivery, Topic, topic_of
from swarm.messages.validation import BadMessageError, decode

M = TypeVar("M", bound=Message)


class Received(NamedTuple, Generic[M]):
    """A checked message, the robot that its key names, and its header."""

    robot: str
    header: Header
    message: M


class Subscription(Generic[M]):
    """The messages of one topic that arrived since the last `take`.

    Of a `NEWEST` topic only the last of each key is kept. A message that repeats or comes before one
    already seen from the same epoch is a duplicate; one from an older epoch is of a dead process. A bad
    message proves nothing about its sender: it does not make those before it look dead.
    """

    def __init__(self, topic: Topic[M]) -> None:
        self.topic = topic
        self._newest_only = topic.delivery is Delivery.NEWEST
        self._waiting: dict[object, tuple[str, Header, bytes]] = {}
        self._seen: dict[str, tuple[int, int]] = {}
        self._believed: dict[str, tuple[int, int]] = {}
        self.duplicates = 0
        self.bad = 0
        self.last_bad = ""
        """Why the last bad message was refused, with its key."""

    def put(self, key: str, header: Header | None, payload: bytes) -> None:
        """Take in what the node received; nothing is decoded yet."""
        if header is None:
            self._refuse(key, "it has no header")
            return
        number = (header.epoch, header.sequence)
        if number <= self._seen.get(key, (0, 0)):
            self.duplicates += 1
            return
        self._seen[key] = number
        slot = key if self._newest_only else (key, number)
        self._waiting.pop(slot, None)
        self._waiting[slot] = (key, header, payload)

    def take(self) -> list[Received[M]]:
        """Everything that waits, in order of arrival."""
        if not self._waiting:
            return []
        waiting, self._waiting = self._waiting, {}
        checked = (self._checked(*message) for message in waiting.values())
        return [received for received in checked if received is not None]

    def _checked(self, key: str, header: Header, payload: bytes) -> Received[M] | None:
        found = topic_of(key)
        if found is None:
            self._refuse(key, "its key is not in the key table")
            return None
        try:
            received = Received(found[1], header, decode(self.topic.message, payload))
        except BadMessageError as error:
            self._seen[key] = self._believed.get(key, (0, 0))
            self._refuse(key, str(error))
            return None
        self._believed[key] = (header.epoch, header.sequence)
        self._seen[key] = max(self._seen[key], self._believed[key])
        return received

    def _refuse(self, key: str, reason: str) -> None:
        self.bad += 1
        self.last_bad = f"{key[:80]!r}: {reason}"


class Subscriptions:
    """Subscriptions of several topics, each of which takes in what is its own."""

    def __init__(self, subscriptions: Iterable[Subscription[Any]]) -> None:
        self._subscriptions = {subscription.topic: subscription for subscription in subscriptions}
        self._by_key: dict[str, Subscription[Any] | None] = {}

    def put(self, items: Iterable[Item]) -> None:
        """Keys that belong to no subscription are passed over."""
        for item in items:
            if item.key not in self._by_key:
                found = topic_of(item.key)
                self._by_key[item.key] = self._subscriptions.get(found[0]) if found else None
            subscription = self._by_key[item.key]
            if subscription is not None:
                subscription.put(*item)

    @property
    def bad(self) -> int:
        """Messages refused so far."""
        return sum(subscription.bad for subscription in self._subscriptions.values())
