"""Where the run's messages come together, in lockstep or in real time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Protocol, TypeVar

from google.protobuf.message import Message

from swarm.logs.ending import Receipt, Sender
from swarm.messages.header import Item
from swarm.messages.topics import Topic

M = TypeVar("M", bound=Message)


class Hub(Protocol):
    """What the conductor of a trial works with."""

    def start(self, meanwhile: Callable[[], None]) -> None:
        """Wait until every process is there; `meanwhile` is called again and again while they are not."""

    @property
    def missing(self) -> list[str]:
        """Who is not there."""

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        """Send a message of the server's own; it is part of the next batch."""

    def advance(self) -> None:
        """Let the processes work on."""

    def gather(self) -> Batch:
        """What they have published since; RunFailedError if one of them is gone."""

    def unsent(self) -> Batch:
        """The server's own messages that no batch has held yet."""

    def finish(self) -> Batch:
        """Tell the processes that the trial is over; what they still had to say."""

    @property
    def recovered(self) -> Mapping[Sender, int]:
        """How many messages of each sender had been lost on their way, and came later."""

    def accounts(self) -> Mapping[Sender, int] | None:
        """The last number of each key and epoch by its sender's own account; None: all of it was heard."""

    def receipts(self) -> Sequence[Receipt]:
        """What the robots' processes have received by their own accounts; in lockstep they write it down."""


class Batch:
    """Messages received by the run's time `t_ns`."""

    def __init__(self, t_ns: int, received: list[Item]) -> None:
        self.t_ns = t_ns
        self._received = received

    @cached_property
    def items(self) -> list[Item]:
        """By key, epoch and sequence: who was quicker does not show. Sorted when first asked for."""
        return sorted(self._received)
