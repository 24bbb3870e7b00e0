"""Writes what was received, as it was received: the wire bytes are the log bytes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message
from small_mcap import CompressionType, McapWriter

from server.hubs.hub import Batch
from swarm.files import new_file
from swarm.messages.topics import topic_of

CHUNK_BYTES = 256 * 1024
"""Smaller ones compress worse; of a larger one more is lost when the recorder is killed."""


class Recorder:
    """One MCAP file of one trial. Payloads are never decoded; schemas are embedded.

    A channel stands for one key and one epoch of its sender, so that a restart shows; the file's
    `sequence` is the header's, its publish time the header's, its log time the time of receipt.
    """

    def __init__(self, path: Path, metadata: Mapping[str, Mapping[str, str]]) -> None:
        self._file = new_file(path)
        self.path = path
        self.messages = 0
        self.unknown_keys: dict[str, int] = {}
        """Keys that the key table does not know, with the number of messages that were left out."""
        self._writer = McapWriter(self._file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="swarm-runtime")
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, int], int | None] = {}
        self._views: dict[str, int] = {}
        for name, values in metadata.items():
            self._writer.add_metadata(name, dict(values))

    def write(self, batch: Batch) -> None:
        """Append a batch; its order is the file's order."""
        for key, header, payload in batch.items:
            name = (key, header.epoch)
            if name not in self._channels:
                self._channels[name] = self._registered(key, header.epoch)
            channel = self._channels[name]
            if channel is None:
                self._leave_out(key)
            else:
                sequence = header.sequence & 0xFFFFFFFF
                self._writer.add_message(channel, batch.t_ns, payload, header.t_ns, sequence)
                self.messages += 1

    def write_view(self, topic: str, message: Message, t_ns: int) -> None:
        """Append a message that the server made for viewers."""
        number = self._views.get(topic, 0) + 1
        self._views[topic] = number
        if number == 1:
            self._channels[topic, 0] = self._channel(topic, type(message), {"made_by": "server"})
        channel = self._channels[topic, 0]
        assert channel is not None
        self._writer.add_message(channel, t_ns, message.SerializeToString(deterministic=True), t_ns, number)

    def flush(self) -> None:
        """End the chunk and hand everything to the operating system: a killed server loses none of it."""
        builder = self._writer.chunk_builder
        assert builder is not None
        chunk = builder.finalize()
        if chunk is not None:
            builder.reset()
            self._writer.add_chunk(*chunk)
        self._file.flush()

    def close(self) -> None:
        """Write the index and close the file; a second call does nothing."""
        if not self._file.closed:
            self._writer.finish()
            self._file.close()

    def _registered(self, key: str, epoch: int) -> int | None:
        """The channel of a key and epoch; None for a key that is not to be logged."""
        found = topic_of(key)
        if found is None or not found[0].logged:
            return None
        topic, robot = found
        about = {"epoch": str(epoch), "robot": robot, "delivery": topic.delivery.value}
        return self._channel(key, topic.message, about)

    def _leave_out(self, key: str) -> None:
        if topic_of(key) is None:
            self.unknown_keys[key] = self.unknown_keys.get(key, 0) + 1

    def _channel(self, key: str, message: type[Message], about: dict[str, str]) -> int:
        number = len(self._writer.channels) + 1
        self._writer.add_channel(number, key, "protobuf", self._schema(message), about)
        return number

    def _schema(self, message: type[Message]) -> int:
        name = message.DESCRIPTOR.full_name
        if name not in self._schemas:
            data = _descriptor_set(message.DESCRIPTOR.file).SerializeToString(deterministic=True)
            self._schemas[name] = len(self._schemas) + 1
            self._writer.add_schema(self._schemas[name], name, "protobuf", data)
        return self._schemas[name]


def _descriptor_set(file: Any) -> FileDescriptorSet:
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
