"""Writes what was received, as it was received: the wire bytes are the log bytes.

A log is the same, byte for byte, in every repetition of a simulated run. So a chunk ends where its size or
the caller says, never when a clock does. What the clock decides is how often the chunk that is still open is
laid down behind the others, to be overwritten when it has grown: a killed server loses a moment, not a chunk.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message

from server.hubs.hub import Batch
from server.recording.disk_sync import DiskSync
from swarm.files import new_file
from swarm.logs.ending import Receipt, Sender, ending_records
from swarm.logs.mcap_writer import LogWriter
from swarm.messages.topics import topic_of
from swarm.messages.validation import MAX_PAYLOAD_BYTES

LAID_DOWN_EVERY_S = 0.2
"""Real seconds of messages that a killed server loses at most; to lay a chunk down takes about 2 ms."""
MAX_MESSAGE_BYTES = 16 * MAX_PAYLOAD_BYTES
"""No larger message is stored. Nobody decodes more than MAX_PAYLOAD_BYTES; a little more can be looked at."""

MOST_EPOCHS = 100
"""Of one key: a robot that restarts more often in a trial is ill, or somebody makes epochs up."""
MOST_CHANNELS = 60_000
"""MCAP numbers them with 16 bits; the rest is for views."""


@dataclass
class LeftOut:
    """Keys with the number of their messages that were not recorded."""

    oversized: Counter[str] = field(default_factory=Counter)
    """Messages above MAX_MESSAGE_BYTES."""
    unknown_keys: Counter[str] = field(default_factory=Counter)
    """The key table does not know the key."""
    restarted_too_often: Counter[str] = field(default_factory=Counter)
    """More senders than can be logged."""
    while_paused: Counter[str] = field(default_factory=Counter)
    """The disk had no room, and the message was none that must not be lost."""


class Recorder:
    """One MCAP file. Payloads are never decoded; schemas are embedded.

    A channel stands for one key and one epoch of its sender, so that a restart shows; the file's
    `sequence` is the header's, its publish time the header's, its log time the time of receipt.
    """

    def __init__(
        self,
        path: Path,
        metadata: Mapping[str, Mapping[str, str]],
        monotonic_s: Callable[[], float] = time.monotonic,
        left_out: LeftOut | None = None,
    ) -> None:
        self._file = new_file(path)
        self._monotonic_s = monotonic_s
        self._due_s = 0.0
        self._laid_down_end = 0
        self._flushed_end = self._flushed_messages = 0
        self.path = path
        self.messages = 0
        self.left_out = left_out or LeftOut()
        self._writer = LogWriter(self._file)
        self._schemas: dict[str, int] = {}
        self._channels: dict[Sender, int | None] = {}
        self.last: dict[Sender, int] = {}
        """The last number of each sender."""
        self._epochs: dict[str, int] = {}
        self._views: dict[str, int] = {}
        try:
            self._add_metadata(metadata)
            self._hand_over()
        except OSError:
            self._drop()
            path.unlink()
            raise
        self._sync = DiskSync(self._file.fileno())

    @property
    def size_bytes(self) -> int:
        """Of the file, as far as it was flushed."""
        return self._flushed_end

    def write(self, batch: Batch) -> None:
        """Append a batch; its order is the file's order."""
        for key, header, payload in batch.items:
            name = (key, header.epoch)
            if name not in self._channels:
                self._channels[name] = self._registered(key, header.epoch)
            channel = self._channels[name]
            if channel is None:
                self._leave_out(key)
                continue
            self.last[name] = sequence = header.sequence & 0xFFFFFFFF
            if len(payload) > MAX_MESSAGE_BYTES:
                self.left_out.oversized[key] += 1
            else:
                self._writer.add_message(channel, batch.t_ns, payload, header.t_ns, sequence)
                self.messages += 1
        if self._monotonic_s() >= self._due_s:
            self._lay_down()

    def write_view(self, topic: str, message: Message, t_ns: int) -> None:
        """Append a message that the server made for viewers."""
        number = self._views.get(topic, 0) + 1
        self._views[topic] = number
        if number == 1:
            self._channels[topic, 0] = self._channel(topic, type(message), {"made_by": "server"})
        channel = self._channels[topic, 0]
        assert channel is not None
        self._writer.add_message(channel, t_ns, message.SerializeToString(deterministic=True), t_ns, number)
        self.messages += 1

    def flush(self) -> None:
        """End the chunk and hand everything to the operating system: a killed server loses none of it."""
        self._writer.end_chunk()
        self._hand_over()

    @property
    def disk_error(self) -> str:
        """Why the disk could not take the log; empty if it could."""
        return str(self._sync.failure or "")

    def end(
        self,
        state: str,
        reason: str,
        accounts: Mapping[Sender, int] | None,
        receipts: Sequence[Receipt] = (),
    ) -> None:
        """Write how the trial ended, and what everybody has sent and received by their own accounts.

        `accounts` is None if the hub had everything that was sent, so that the last number written is the
        last one sent.
        """
        self.flush()
        self._add_metadata(
            ending_records(state, reason, self.last if accounts is None else accounts, receipts)
        )

    def received(self) -> dict[Sender, int]:
        """How many messages of each sender were written, and flushed."""
        counts = self._writer.messages_by_channel()
        return {
            sender: counts.get(channel, 0)
            for sender, channel in self._channels.items()
            if channel is not None and sender[1]
        }

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        self._writer.add_metadata(name, dict(values))

    def close(self) -> None:
        """Write the index and close the file; a second call does nothing."""
        if not self._file.closed:
            self._writer.finish()
            self._file.truncate()
            self._file.flush()
            self._sync.close()
            self._file.close()

    def abandon(self) -> None:
        """Leave the file as it was when it was flushed last, since the disk takes no more."""
        self.messages = self._flushed_messages
        with suppress(OSError):
            os.ftruncate(self._file.fileno(), self._flushed_end)
        self._sync.close()
        self._drop()

    def _lay_down(self) -> None:
        """Put the open chunk where it will stand, as it is now; what is written next overwrites it."""
        self._due_s = self._monotonic_s() + LAID_DOWN_EVERY_S
        self._laid_down_end = max(self._laid_down_end, self._writer.lay_down())

    def _hand_over(self) -> None:
        """Leave nothing behind the last record: a chunk that was laid down may have been packed worse."""
        if self._laid_down_end > self._file.tell():
            self._file.truncate()
        self._laid_down_end = 0
        self._file.flush()
        self._flushed_end, self._flushed_messages = self._file.tell(), self.messages

    def _drop(self) -> None:
        """Close the file without what is still to be written into it."""
        self._file.raw.close()

    def _add_metadata(self, metadata: Mapping[str, Mapping[str, str]]) -> None:
        for name, values in metadata.items():
            self._writer.add_metadata(name, dict(values))

    def _registered(self, key: str, epoch: int) -> int | None:
        """The channel of a key and epoch; None for a key that is not to be logged, or has too many."""
        found = topic_of(key)
        if found is None or not found[0].logged:
            return None
        epochs = self._epochs.get(key, 0)
        if epochs == MOST_EPOCHS or len(self._writer.channels) >= MOST_CHANNELS:
            return None
        self._epochs[key] = epochs + 1
        topic, robot = found
        about = {"epoch": str(epoch), "robot": robot, "delivery": topic.delivery.value}
        return self._channel(key, topic.message, about)

    def _leave_out(self, key: str) -> None:
        """Count a message, unless its topic is one that is never logged."""
        found = topic_of(key)
        if found is None:
            self.left_out.unknown_keys[key] += 1
        elif found[0].logged:
            self.left_out.restarted_too_often[key] += 1

    def _channel(self, key: str, message: type[Message], about: dict[str, str]) -> int:
        number = len(self._writer.channels) + 1
        self._writer.add_channel(number, key, "protobuf", self._schema(message), about)
        return number

    def _schema(self, message: type[Message]) -> int:
        name = message.DESCRIPTOR.full_name
        if name not in self._schemas:
            data = descriptor_set(message.DESCRIPTOR.file).SerializeToString(deterministic=True)
            self._schemas[name] = len(self._schemas) + 1
            self._writer.add_schema(self._schemas[name], name, "protobuf", data)
        return self._schemas[name]


def descriptor_set(file: Any) -> FileDescriptorSet:
    """A schema file and everything that it imports, dependencies first and each once."""
    found: dict[str, Any] = {}

    def visit(one: Any) -> None:
        for dependency in one.dependencies:
            visit(dependency)
        found[one.name] = one

    visit(file)
    files = FileDescriptorSet()
    for one in found.values():
        one.CopyToProto(files.file.add())
    return files


def digest(paths: Iterable[Path]) -> str:
    """SHA-256 over the contents of log files, in order."""
    total = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            while block := file.read(1 << 20):
                total.update(block)
    return total.hexdigest()
