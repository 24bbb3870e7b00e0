"""Makes a damaged log whole: all that can be read of it, in a new file with an index and checksums."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata, Schema
from small_mcap import CompressionType, McapWriter

from swarm.files import new_file
from swarm.logs.mcap_records import (
    BROKEN,
    DamagedChunkError,
    FramingError,
    Record,
    decoded,
    indexed_definitions,
    places,
    records,
    unpack,
)
from swarm.logs.reader import Damage, LogError, open_log

CHUNK_BYTES = 256 * 1024


@dataclass(frozen=True)
class Recovery:
    """What came of a log: the messages in the new file, and why what is missing could not be read."""

    messages: int
    lost: list[Damage]


def recover_log(damaged: Path, whole: Path) -> Recovery:
    """Copy every record that can be read; of a damaged chunk nothing is copied.

    LogError for what is no log or holds no message that can be read, UserError if `whole` cannot be made.
    """
    with open_log(damaged) as source, new_file(whole) as target:
        copy = _Copy(target)
        try:
            copy.take_all(source)
            copy.finish()
        except BaseException:
            whole.unlink()
            raise
    if copy.messages == 0:
        whole.unlink()
        reason = f": {copy.lost[0]}" if copy.lost else ""
        raise LogError(damaged, f"no message can be read from this log{reason}")
    return Recovery(copy.messages, copy.lost)


class _Copy:
    """The new log while it is written."""

    def __init__(self, target: BinaryIO) -> None:
        self.messages = 0
        self.lost: list[Damage] = []
        self._writer = McapWriter(target, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="swarm-runtime")

    def take_all(self, source: BinaryIO) -> None:
        """Every record up to the index, which is made anew, or to where the log cannot be followed.

        The index repeats the schemas and channels: if it is there, it is believed, because a single one
        of them has no checksum.
        """
        self._take_definitions_of_index(source)
        try:
            for record in records(source):
                if record.opcode == Opcode.DATA_END:
                    break
                self._take(record)
        except FramingError as error:
            self._lose(error, error.offset_bytes)

    def finish(self) -> None:
        """Write the index."""
        self._writer.finish()

    def _take_definitions_of_index(self, source: BinaryIO) -> None:
        try:
            self._add(list(indexed_definitions(source)))
        except BROKEN as error:
            self._lose(f"the index is damaged: {error}", 0)
        source.seek(0)

    def _take(self, record: Record) -> None:
        """All of a record, or nothing if any of it makes no sense."""
        try:
            found = list(_contents(record))
            self._check(found)
            self._add(found)
        except BROKEN as error:
            self._lose(error, record.offset_bytes)

    def _check(self, found: list[object]) -> None:
        """Raises one of BROKEN for a definition that contradicts an earlier one, or a message without one."""
        channels = set(self._writer.channels)
        for one in found:
            if isinstance(one, Channel):
                known = self._writer.channels.get(one.id)
                if known and (known.topic, known.schema_id) != (one.topic, one.schema_id):
                    raise DamagedChunkError(f"channel {one.id} is defined twice, for two different keys")
                channels.add(one.id)
            elif isinstance(one, Message) and one.channel_id not in channels:
                raise DamagedChunkError(f"a message of channel {one.channel_id}, which is not defined")

    def _add(self, found: list[object]) -> None:
        writer = self._writer
        for one in found:
            if isinstance(one, Message):
                writer.add_message(one.channel_id, one.log_time, one.data, one.publish_time, one.sequence)
                self.messages += 1
            elif isinstance(one, Schema) and one.id not in writer.schemas:
                writer.add_schema(one.id, one.name, one.encoding, one.data)
            elif isinstance(one, Channel) and one.id not in writer.channels:
                about = dict(one.metadata)
                writer.add_channel(one.id, one.topic, one.message_encoding, one.schema_id, about)
            elif isinstance(one, Metadata):
                writer.add_metadata(one.name, dict(one.metadata))

    def _lose(self, reason: object, offset_bytes: int) -> None:
        self.lost.append(Damage(offset_bytes, self.messages, str(reason)))


def _contents(record: Record) -> Iterator[object]:
    """What a record holds: one, or all of a chunk."""
    found = decoded(record.opcode, record.body)
    if isinstance(found, Chunk):
        inside = unpack(found.compression, found.data, found.uncompressed_size, found.uncompressed_crc)
        for opcode, body, end in places(inside):
            yield decoded(opcode, inside[body:end])
    else:
        yield found
