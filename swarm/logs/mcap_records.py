"""The records of an MCAP file: their framing, the insides of chunks, and those that are decoded here."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any, BinaryIO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata, Schema, Statistics

MAGIC = b"\x89MCAP0\r\n"
MAX_RECORD_BYTES = 64 * 1024 * 1024
"""No record, and no chunk when unpacked, may be larger."""
_RECORD = struct.Struct("<BQ")
_CRC = struct.Struct("<I")
_FOOTER = struct.Struct("<BQQQI8s")
"""The footer, with the place of the index in the third field, and the closing magic."""


class FramingError(ValueError):
    """The records cannot be followed any further than `offset_bytes`; the text says why."""

    def __init__(self, reason: str, offset_bytes: int) -> None:
        super().__init__(reason)
        self.offset_bytes = offset_bytes


class Record(NamedTuple):
    """A record's kind, the place in the file where it begins, and its contents."""

    opcode: int
    offset_bytes: int
    body: bytes


def records(file: BinaryIO) -> Iterator[Record]:
    """Every record up to the footer; FramingError where the file is cut short or makes no sense.

    A checksum over all messages, where a writer left one, is verified.
    """
    size = os.fstat(file.fileno()).st_size
    crc = zlib.crc32(magic := file.read(len(MAGIC)))
    if magic != MAGIC:
        raise FramingError("is not an MCAP log: it does not begin like one", 0)
    offset, opcode = len(MAGIC), 0
    while opcode != Opcode.FOOTER:
        header = file.read(_RECORD.size)
        opcode, body = _body(file, header, offset, size)
        if opcode == Opcode.DATA_END and _CRC.unpack_from(body)[0] not in (0, crc):
            raise FramingError("the checksum (CRC) over all records is wrong", offset)
        crc = zlib.crc32(body, zlib.crc32(header, crc))
        if opcode != Opcode.MESSAGE_INDEX:
            yield Record(opcode, offset, body)
        offset += len(header) + len(body)
    if file.read(len(MAGIC)) != MAGIC:
        raise FramingError("the log does not end as an MCAP log should", offset)


def summary_records(file: BinaryIO) -> Iterator[Record]:
    """The records of the index at the end, which repeats the schemas and channels; none if there is no index.

    FramingError if the index makes no sense.
    """
    size = os.fstat(file.fileno()).st_size
    file.seek(max(0, size - _FOOTER.size))
    end = file.read(_FOOTER.size)
    if len(end) < _FOOTER.size or not end.endswith(MAGIC):
        return
    offset = _FOOTER.unpack(end)[2]
    file.seek(min(offset, size))
    while 0 < offset < size - _FOOTER.size:
        header = file.read(_RECORD.size)
        opcode, body = _body(file, header, offset, size)
        yield Record(opcode, offset, body)
        offset += len(header) + len(body)


def _body(file: BinaryIO, header: bytes, offset: int, size: int) -> tuple[int, bytes]:
    """The kind and the contents of the record whose header has just been read."""
    if len(header) < _RECORD.size:
        raise FramingError("the log is cut short here", offset)
    opcode, length = _RECORD.unpack(header)
    if offset + _RECORD.size + length > size:
        raise FramingError("the log is cut short here, within a record", offset)
    if length > MAX_RECORD_BYTES:
        raise FramingError(f"a record of {length} bytes; at most {MAX_RECORD_BYTES} are read", offset)
    return opcode, file.read(length)


MESSAGE = 0x05
_MESSAGE = struct.Struct("<HIQQ")


class DamagedChunkError(ValueError):
    """A chunk whose contents cannot be trusted; the text says why."""


Entry = tuple[int, int, int, bytes]
"""One message: sequence number, times of receipt and of publishing in ns, and the payload as it was sent."""


class Definition(NamedTuple):
    """Any other record of a chunk: a schema or a channel, undecoded."""

    opcode: int
    body: bytes


@dataclass
class ChunkRecords:
    """What a chunk holds: its schemas and channels, and the messages of each channel in order."""

    definitions: list[Definition] = field(default_factory=list)
    entries: dict[int, list[Entry]] = field(default_factory=dict)


def unpack(compression: str, data: bytes, size: int, crc: int) -> bytes:
    """A chunk's records: exactly `size` bytes with this CRC-32 (0: none was written)."""
    if size > MAX_RECORD_BYTES:
        raise DamagedChunkError(f"a chunk claims {size} bytes unpacked; at most {MAX_RECORD_BYTES} are read")
    try:
        records = _decompress(compression, data, size + 1)
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise DamagedChunkError(f"a chunk cannot be unpacked ({error})") from error
    if len(records) != size:
        raise DamagedChunkError("a chunk does not unpack to the size that it claims")
    if crc not in (0, zlib.crc32(records)):
        raise DamagedChunkError("a chunk's checksum (CRC) is wrong")
    return records


def _decompress(compression: str, data: bytes, limit: int) -> bytes:
    """At most `limit` bytes of what was compressed."""
    if compression == "zstd":
        return zstandard.ZstdDecompressor().stream_reader(BytesIO(data)).read(limit)
    if compression == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=limit))
    if compression:
        raise DamagedChunkError(f"a chunk is compressed with {compression!r}; zstd and lz4 are known")
    return data


def places(records: bytes) -> Iterator[tuple[int, int, int]]:
    """Of each record of an unpacked chunk: its kind, and where its contents begin and end."""
    header, at, end = _RECORD.unpack_from, 0, len(records)
    while at < end:
        if at + _RECORD.size > end:
            raise DamagedChunkError("a chunk ends within a record")
        opcode, length = header(records, at)
        body, at = at + _RECORD.size, at + _RECORD.size + length
        if at > end or (opcode == MESSAGE and length < _MESSAGE.size):
            raise DamagedChunkError("a chunk holds a record of an impossible length")
        yield opcode, body, at


def split(records: bytes) -> ChunkRecords:
    """Sort an unpacked chunk's records. This loop sees every message of a log: it stays this plain."""
    found = ChunkRecords()
    entries, fields = found.entries, _MESSAGE.unpack_from
    for opcode, body, end in places(records):
        if opcode != MESSAGE:
            found.definitions.append(Definition(opcode, records[body:end]))
            continue
        channel, sequence, receive_t_ns, publish_t_ns = fields(records, body)
        entry = (sequence, receive_t_ns, publish_t_ns, records[body + _MESSAGE.size : end])
        if channel in entries:
            entries[channel].append(entry)
        else:
            entries[channel] = [entry]
    return found


BROKEN = (McapError, DamagedChunkError, ValueError, OverflowError, struct.error)
"""What a damaged record raises when it is decoded."""
_READ: dict[int, Any] = {
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.CHUNK: Chunk.read,
    Opcode.METADATA: Metadata.read,
    Opcode.STATISTICS: Statistics.read,
}


def decoded(opcode: int, body: bytes) -> object:
    """A record of a kind that is needed here; None for any other."""
    stream = ReadDataStream(BytesIO(body))
    if opcode == Opcode.MESSAGE:
        return Message.read(stream, len(body))
    read = _READ.get(opcode)
    return read(stream) if read else None


def indexed_definitions(file: BinaryIO) -> Iterator[object]:
    """The schemas and channels that the index repeats; raises one of BROKEN if it makes no sense."""
    for record in summary_records(file):
        if record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            yield decoded(record.opcode, record.body)
