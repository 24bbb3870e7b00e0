"""What a log is read as: channels, and parts of many messages of one channel at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from swarm.analysis.log_chunks import Entry
from swarm.keys import Topic, topic_of

PART_MESSAGES = 4096
PART_BYTES = 1024 * 1024


@dataclass(frozen=True)
class LogChannel:
    """The messages of one key from one start (epoch) of its sender."""

    id: int
    key: str
    epoch: int
    schema: str
    encoding: str

    @cached_property
    def topic(self) -> Topic[Any] | None:
        """Its line of the key table, if its messages are of the type that the table says."""
        found = topic_of(self.key)
        if found is None or self.encoding != "protobuf":
            return None
        return found[0] if found[0].message.DESCRIPTOR.full_name == self.schema else None

    @property
    def is_for_viewers(self) -> bool:
        """Whether the server made its messages out of others, for viewers to draw."""
        return self.schema.startswith("foxglove.")

    @property
    def sender(self) -> str:
        """The robot's id; "tracker", "server" or "run" for a key that names no robot."""
        found = topic_of(self.key)
        return (found[1] if found else "") or self.key.split("/")[0]


@dataclass(frozen=True)
class Part:
    """Messages of one channel in the log's order: `sequence`, `receive_t_ns` and `publish_t_ns` (messages,);
    `payloads` is empty if the channel's contents were not asked for.
    """

    channel: LogChannel
    sequence: npt.NDArray[np.int64]
    receive_t_ns: npt.NDArray[np.int64]
    publish_t_ns: npt.NDArray[np.int64]
    payloads: list[bytes]


@dataclass
class PendingPart:
    """Collects the messages of one channel until they are worth a part."""

    channel: LogChannel
    keep_payloads: bool
    entries: list[Entry] = field(default_factory=list)
    payload_bytes: int = 0

    def add(self, entries: list[Entry]) -> bool:
        """Whether the part is large enough now."""
        if self.keep_payloads:
            self.payload_bytes += sum(len(entry[3]) for entry in entries)
        else:
            entries = [(sequence, receive, publish, b"") for sequence, receive, publish, _ in entries]
        self.entries += entries
        return len(self.entries) >= PART_MESSAGES or self.payload_bytes >= PART_BYTES

    def take(self) -> Part:
        """The part; another one begins."""
        sequence, receive, publish, payloads = zip(*self.entries, strict=True)
        self.entries, self.payload_bytes = [], 0
        return Part(
            self.channel,
            np.array(sequence, dtype=np.int64),
            np.array(receive, dtype=np.uint64).astype(np.int64),
            np.array(publish, dtype=np.uint64).astype(np.int64),
            list(payloads) if self.keep_payloads else [],
        )


Wanted = Callable[[LogChannel], bool]


def everything(channel: LogChannel) -> bool:
    """Payloads of every channel are wanted."""
    return bool(channel.key)


def nothing(channel: LogChannel) -> bool:
    """No payload is wanted: keys, numbers and times are enough."""
    return not channel.key
