"""A log from front to back, chunk by chunk, also while it is being written.

A recorder lays its open chunk down several times a second, and overwrites it when it has grown. So the last
chunk is read again, and of it only what is new, until another record stands behind it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

from swarm.logs.mcap_chunks import Entry, chunk_head, split, unpack
from swarm.logs.mcap_records import (
    BROKEN,
    MAGIC,
    Frame,
    FramingError,
    decoded,
    frame_at,
    read_record,
    size_of,
)
from swarm.logs.reader import LogChannel, LogError, Wanted, everything, open_log
from swarm.messages.header import Header, Item

Timed = tuple[int, Item]
"""When the recorder received a message, in nanoseconds of the run, and the message."""


class LogFollower:
    """Gives the messages of a log in the order in which they were recorded, as far as they are written.

    Only the channels that are `wanted` are given, and none that this project does not know. `read` may be
    called again and again; `ended` says whether the recorder has closed the log.
    """

    def __init__(self, path: Path, wanted: Wanted = everything) -> None:
        self.path = path
        self._wanted = wanted
        self.ended = False
        self.metadata: dict[str, dict[str, str]] = {}
        self._file: BinaryIO = open_log(path)
        self._at = len(MAGIC)
        self._taken: dict[int, int] = {}
        """Messages of each channel that were given of the chunk that is read next."""
        self._seen = (0, 0)
        """Size and time of change of the file when its last chunk was read."""
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, LogChannel] = {}
        if self._file.read(len(MAGIC)) != MAGIC:
            self._file.close()
            raise LogError(path, "is not an MCAP log: it does not begin like one")

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    @property
    def is_closed(self) -> bool:
        """Whether the file ends as a finished log does."""
        self._file.seek(max(0, size_of(self._file) - len(MAGIC)))
        return self._file.read() == MAGIC

    @property
    def share(self) -> float:
        """How much of the file has been read, from 0 to 1."""
        return min(1.0, self._at / max(1, size_of(self._file)))

    def read(self) -> Iterator[list[Timed]]:
        """What is new, a chunk at a time. LogError if the log is damaged before its end."""
        while not self.ended and (state := self._state()) != self._seen:
            # Looked at first: a chunk that grows meanwhile is still the last.
            size, _ = state
            try:
                frame = frame_at(self._file, self._at, size)
                found = self._of(frame)
            except (FramingError, *BROKEN) as error:
                self._forgive(error)
                return
            is_last = frame.end_bytes >= size
            if is_last:
                self._seen = state
            else:
                self.ended = frame.opcode == Opcode.DATA_END
                self._at, self._taken = frame.end_bytes, {}
            if found:
                yield found

    def _state(self) -> tuple[int, int]:
        """The file's size in bytes, and when it was changed."""
        now = os.fstat(self._file.fileno())
        return now.st_size, now.st_mtime_ns

    def _forgive(self, error: Exception) -> None:
        """What is being written may be cut off anywhere. Before the end of a closed log nothing may."""
        if self.is_closed:
            cure = f"make a sound one with: swarm recover {self.path}"
            raise LogError(self.path, f"is damaged ({error}); {cure}", self._at) from error

    def _of(self, frame: Frame) -> list[Timed]:
        if frame.opcode == Opcode.CHUNK:
            return self._of_chunk(frame)
        if frame.opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
            self._define(read_record(self._file, frame))
        return []

    def _of_chunk(self, frame: Frame) -> list[Timed]:
        content = split(unpack(self._file, chunk_head(self._file, frame)))
        for definition in content.definitions:
            self._define(decoded(definition.opcode, definition.body))
        found = [
            _timed(self._channels[number], entry)
            for number, entries in content.entries.items()
            if number in self._channels
            for entry in entries[self._taken.get(number, 0) :]
        ]
        self._taken = {number: len(entries) for number, entries in content.entries.items()}
        found.sort(key=lambda timed: timed[0])
        return found

    def _define(self, record: object) -> None:
        if isinstance(record, Metadata):
            self.metadata.setdefault(record.name, record.metadata)
        elif isinstance(record, Schema):
            self._schemas[record.id] = record.name
        elif isinstance(record, Channel):
            schema = self._schemas.get(record.schema_id, "")
            channel = LogChannel.of(record, schema)
            if channel.topic and self._wanted(channel):
                self._channels[record.id] = channel


def _timed(channel: LogChannel, entry: Entry) -> Timed:
    sequence, receive_t_ns, publish_t_ns, payload = entry
    return receive_t_ns, Item(channel.key, Header(channel.epoch, sequence, publish_t_ns), payload)
