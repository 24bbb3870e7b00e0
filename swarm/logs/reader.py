"""The only reader of logs. It trusts nothing: every checksum is verified, memory and time are bounded, and
of a damaged log it gives everything that is whole, and says where the damage is.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode
from mcap.records import Channel, Message, Metadata, Schema, Statistics

from swarm.errors import UserError
from swarm.logs.chain import CHAIN, CONTINUES, Chain
from swarm.logs.mcap_chunks import Entry, split
from swarm.logs.mcap_index import read_index
from swarm.logs.mcap_records import (
    BROKEN,
    BrokenRecordError,
    FramingError,
    Record,
    decoded,
    frame_at,
    read_record,
    size_of,
)
from swarm.logs.mcap_walk import Walk
from swarm.messages.topics import Topic, topic_of

S_PER_NS = 1e-9
"""Logs count nanoseconds."""
PART_MESSAGES = 4096
PART_BYTES = 1024 * 1024
"""A part is whatever of the two is reached first: enough to decode in bulk, and a megabyte of memory."""


@dataclass(frozen=True)
class LogChannel:
    """The messages of one key from one start (epoch) of its sender."""

    id: int
    key: str
    epoch: int
    schema: str
    encoding: str

    @classmethod
    def of(cls, record: Channel, schema: str) -> LogChannel:
        """As a file defines it, with the name of its schema."""
        epoch = record.metadata.get("epoch", "")
        number = int(epoch) if epoch.isascii() and epoch.isdecimal() and len(epoch) < 20 else 0
        return cls(record.id, record.topic, min(number, MAX_EPOCH), schema, record.message_encoding)

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
    def publisher(self) -> str:
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


MAX_EPOCH = 2**63 - 1
"""The largest that the tables' signed columns hold."""
SAID_ONCE = ("run", "robots", "experiment", "versions", "end", "sent", "received", CHAIN, CONTINUES)
"""Metadata of this project's recorder. Other programs give the same name to several records."""


class LogError(UserError):
    """A file that cannot be read as a log: `offset_bytes` into it, after `messages` whole messages."""

    def __init__(self, path: Path, reason: str, offset_bytes: int = 0, messages: int = 0) -> None:
        super().__init__(f"{path}: {reason}")
        self.offset_bytes = offset_bytes
        self.messages = messages


@dataclass(frozen=True)
class Damage:
    """What could not be read, where in the file, and how many messages had been read before."""

    offset_bytes: int
    messages: int
    reason: str

    def __str__(self) -> str:
        return f"{self.reason} (at byte {self.offset_bytes}, after {self.messages} messages)"


class LogReader:
    """Reads one log once, from front to back.

    `wanted` says which channels' payloads are needed; of the others only numbers and times are kept. `chain`
    grows with the chunks, to be compared. What the log says of itself fills while `parts` is gone through and
    is complete afterwards.
    """

    def __init__(self, path: Path, wanted: Wanted = everything, chain: Chain | None = None) -> None:
        self.path = path
        self.metadata: dict[str, dict[str, str]] = {}
        self.channels: dict[int, LogChannel] = {}
        self.damage: list[Damage] = []
        self.contradictions: set[str] = set()
        """Names of metadata records that there are twice, and that differ."""
        self.unverified: list[str] = []
        """What no checksum vouches for: nothing in a log of this project's own recorder."""
        self.messages = 0
        self.recorded_messages: int | None = None
        """As the log's index says; None if it has none, as when the recorder was killed."""
        self._wanted = wanted
        self._chain = chain
        self._definitions = Definitions()
        self._pending: dict[int, PendingPart] = {}

    def parts(self) -> Iterator[Part]:
        """Every message that is whole; LogError for what is no log, or a log without a single message."""
        for record in self._records():
            yield from self._take(record)
        self._compare_with_index()
        yield from [pending.take() for pending in self._pending.values() if pending.entries]
        if self.messages == 0:
            reason = f": {self.damage[0]}" if self.damage else ""
            raise LogError(self.path, f"no message can be read from this log{reason}")

    def read_metadata(self) -> dict[str, dict[str, str]]:
        """How the log was made and how it ended, wherever in the file this stands; reads no message."""
        for record in self._records((Opcode.METADATA,)):
            list(self._take(record))
        return self.metadata

    def read_index(self) -> Statistics | None:
        """Channels, metadata and the counts of messages by an index whose checksum is right; reads nothing
        else, so it takes no longer for a large log. None if there is no such index.
        """
        with open_log(self.path) as file:
            index, size = read_index(file), size_of(file)
            if not index.verified or index.statistics is None:
                return None
            try:
                for definition in index.definitions:
                    self._define(definition)
                for offset in index.metadata:
                    self._define(read_record(file, frame_at(file, offset, size)))
            except (*BROKEN, FramingError):
                return None
        return index.statistics

    def _records(self, wanted: Collection[int] | None = None) -> Iterator[Record]:
        """The file's records, also those beyond a damaged place."""
        with open_log(self.path) as file:
            walk = Walk(file, self._note, wanted)
            self._learn_from_index(walk)
            try:
                yield from walk.records()
            except FramingError as error:
                raise LogError(self.path, str(error)) from error
            self.unverified += walk.unverified

    def _learn_from_index(self, walk: Walk) -> None:
        """A sound index vouches for the channels, so that a damaged one costs no message."""
        if walk.index.statistics is not None:
            self.recorded_messages = walk.index.statistics.message_count
        for definition in walk.index.definitions if walk.index.verified else ():
            self._define(definition)

    def _take(self, record: Record) -> Iterator[Part]:
        """The parts that a record completes. Of one that is damaged nothing is taken."""
        try:
            parts = list(self._contents(record))
        except BROKEN as error:
            self._note(record.offset_bytes, str(error))
        else:
            yield from parts

    def _contents(self, record: Record) -> Iterator[Part]:
        if record.opcode == Opcode.CHUNK:
            if self._chain:
                self._chain.add(record.body)
            content = split(record.body)
            for definition in content.definitions:
                self._define(decoded(definition.opcode, definition.body))
            yield from self._add(content.entries)
            return
        found = decoded(record.opcode, record.body) if record.opcode != Opcode.ATTACHMENT else None
        if isinstance(found, Message):
            entry = (found.sequence, found.log_time, found.publish_time, found.data)
            yield from self._add({found.channel_id: [entry]})
        else:
            self._define(found)

    def _define(self, record: object) -> None:
        """Learn what the log says of itself; BrokenRecordError if it has said something else before."""
        if isinstance(record, Metadata):
            first = self.metadata.setdefault(record.name, record.metadata)
            if record.name in SAID_ONCE and first != record.metadata:
                self.contradictions.add(record.name)
                raise BrokenRecordError(f"two metadata records {record.name!r} that differ")
        elif isinstance(record, Schema | Channel):
            self._definitions.add(record)
            if isinstance(record, Channel):
                schema = self._definitions.schema_name(record.schema_id)
                self.channels[record.id] = LogChannel.of(record, schema)

    def _add(self, entries: dict[int, list[Entry]]) -> Iterator[Part]:
        """The parts that are large enough; nothing is added if any of the channels is unknown."""
        missing = entries.keys() - self.channels.keys()
        if missing:
            raise BrokenRecordError(f"a message of channel {min(missing)}, which is not defined")
        for number, of_channel in entries.items():
            pending = self._pending.get(number) or self._begin(self.channels[number])
            self.messages += len(of_channel)
            if pending.add(of_channel):
                yield pending.take()

    def _begin(self, channel: LogChannel) -> PendingPart:
        pending = PendingPart(channel, self._wanted(channel))
        self._pending[channel.id] = pending
        return pending

    def _compare_with_index(self) -> None:
        """A record that became another one by a flipped bit shows here, too."""
        if not self.damage and self.recorded_messages not in (None, self.messages):
            reason = f"the index promises {self.recorded_messages} messages, {self.messages} were found"
            self._note(self.path.stat().st_size, reason)

    def _note(self, offset_bytes: int, reason: str) -> None:
        self.damage.append(Damage(offset_bytes, self.messages, reason))


class Definitions:
    """The schemas and channels of a log, each number once."""

    def __init__(self) -> None:
        self._known: dict[tuple[type, int], Schema | Channel] = {}

    def check(self, record: Schema | Channel) -> None:
        """BrokenRecordError if its number stands for something else."""
        known = self._known.get((type(record), record.id), record)
        if known != record:
            kind = "channel" if isinstance(record, Channel) else "schema"
            raise BrokenRecordError(f"{kind} {record.id} is defined twice, for two different things")

    def add(self, record: Schema | Channel) -> bool:
        """Whether it is new; BrokenRecordError if its number stands for something else."""
        self.check(record)
        return self._known.setdefault((type(record), record.id), record) is record

    def schema_name(self, number: int) -> str:
        """Empty for a schema that is not known."""
        schema = self._known.get((Schema, number))
        return schema.name if isinstance(schema, Schema) else ""


def open_log(path: Path) -> BufferedReader:
    """Open a regular file for reading; LogError for anything else, without waiting for a pipe."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        raise LogError(path, f"cannot be opened ({error.strerror})") from error
    state = os.fstat(descriptor)
    if not stat.S_ISREG(state.st_mode) or state.st_size == 0:
        os.close(descriptor)
        raise LogError(path, f"is not an MCAP log: {_kind(state.st_mode)}")
    return open(descriptor, "rb")


def _kind(mode: int) -> str:
    if stat.S_ISREG(mode):
        return "it is empty (0 bytes)"
    return "it is a directory" if stat.S_ISDIR(mode) else "it is no regular file"
