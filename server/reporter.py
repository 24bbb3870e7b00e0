"""What the server itself says in a trial: messages to the robots, events for the log."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar

from google.protobuf.message import Message

from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.topics import Topic

M = TypeVar("M", bound=Message)


class Wire(Protocol):
    """Where messages of the server's own are sent: a hub."""

    def publish(self, topic: Topic[Any], message: Message, robot: str = "") -> None:
        """Send a message under the topic's key, of a robot if it is about one."""


class Reporter:
    """The one door through which the parts of the server speak."""

    def __init__(self, wire: Wire) -> None:
        self._wire = wire

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        """Send a message, to or about a robot, or to all."""
        self._wire.publish(topic, message, robot)

    def event(self, name: str, text: str, level: pb.Event.Level.ValueType = pb.Event.INFO) -> None:
        """Put something that a person should know into the log."""
        self.publish(topics.SERVER_EVENT, pb.Event(level=level, name=name, text=text))
