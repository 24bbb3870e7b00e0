"""Chunks of an MCAP file: their heads, their contents unpacked and verified, and these sorted.

A chunk that is larger than any record may be is unpacked twice in pieces: to verify it, then to read it.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import BinaryIO, NamedTuple, Protocol

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from swarm.logs.mcap_records import (
    MAX_RECORD_BYTES,
    PIECE_BYTES,
    RECORD_HEADER,
    BrokenRecordError,
    Frame,
    Record,
)

MAX_UNPACKED_BYTES = 1024 * 1024 * 1024
"""No chunk that unpacks to more is read: what is small and unpacks without end would take for ever."""
MESSAGE = 0x05
_MESSAGE = struct.Struct("<HIQQ")
_HEAD = struct.Struct("<QQQII")
"""First and last time, unpacked size, CRC-32 of what is unpacked, length of the compression's name."""
_LENGTH = struct.Struct("<Q")
_LONGEST_NAME_BYTES = 32
COMPRESSIONS = ("", "lz4", "zstd")


class DamagedChunkError(BrokenRecordError):
    """A chunk whose contents cannot be trusted; the text says why."""


Entry = tuple[int, int, int, bytes]
"""One message: sequence number, times of receipt and of publishing in ns, and the payload as it was sent."""


class ChunkHead(NamedTuple):
    """What a chunk says of its contents, and where in the file these are, compressed."""

    unpacked_bytes: int
    crc: int
    """Of the unpacked contents; 0 if none was written."""
    compression: str
    data_bytes: int
    end_bytes: int

    @property
    def is_large(self) -> bool:
        """Whether it has to be read in pieces."""
        return max(self.unpacked_bytes, self.end_bytes - self.data_bytes) > MAX_RECORD_BYTES


def chunk_head(file: BinaryIO, frame: Frame) -> ChunkHead:
    """Read a chunk's head; DamagedChunkError if it contradicts itself."""
    file.seek(frame.body_bytes)
    start = file.read(min(frame.length_bytes, _HEAD.size + _LONGEST_NAME_BYTES + _LENGTH.size))
    try:
        _, _, unpacked, crc, name_bytes = _HEAD.unpack_from(start)
        if name_bytes > _LONGEST_NAME_BYTES:
            raise DamagedChunkError(f"a chunk's compression has a name of {name_bytes} bytes")
        name = start[_HEAD.size : _HEAD.size + name_bytes]
        (packed,) = _LENGTH.unpack_from(start, _HEAD.size + name_bytes)
    except struct.error as error:
        raise DamagedChunkError("a chunk is too short for its head") from error
    data = frame.body_bytes + _HEAD.size + name_bytes + _LENGTH.size
    if data + packed != frame.end_bytes:
        raise DamagedChunkError("a chunk's lengths contradict each other")
    compression = name.decode("utf-8", "backslashreplace")
    if compression not in COMPRESSIONS:
        raise DamagedChunkError(f"a chunk is compressed with {compression!r}; zstd and lz4 are known")
    if unpacked > MAX_UNPACKED_BYTES:
        raise DamagedChunkError(
            f"a chunk claims {unpacked} bytes unpacked; at most {MAX_UNPACKED_BYTES} are read"
        )
    return ChunkHead(unpacked, crc, compression, data, frame.end_bytes)


def unpack(file: BinaryIO, head: ChunkHead) -> bytes:
    """A chunk's records, verified; DamagedChunkError if they are not what the head says."""
    file.seek(head.data_bytes)
    data = file.read(head.end_bytes - head.data_bytes)
    try:
        records = _decompress(head.compression, data, head.unpacked_bytes + 1)
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise DamagedChunkError(f"a chunk cannot be unpacked ({error})") from error
    _verify(head, len(records), zlib.crc32(records))
    return records


def _decompress(compression: str, data: bytes, limit: int) -> bytes:
    """At most `limit` bytes of what was compressed."""
    if compression == "zstd":
        return zstandard.ZstdDecompressor().stream_reader(BytesIO(data)).read(limit)
    if compression == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=limit))
    return data


def _verify(head: ChunkHead, size_bytes: int, crc: int) -> None:
    if size_bytes != head.unpacked_bytes:
        raise DamagedChunkError("a chunk does not unpack to the size that it claims")
    if head.crc not in (0, crc):
        raise DamagedChunkError("a chunk's checksum (CRC) is wrong")


class _Source(Protocol):
    def read(self, size: int, /) -> bytes: ...


class _Stretch:
    """A stretch of a file as a file of its own."""

    def __init__(self, file: BinaryIO, begin_bytes: int, end_bytes: int) -> None:
        self._file, self._at, self._end = file, begin_bytes, end_bytes

    def read(self, size: int = -1, /) -> bytes:
        left = self._end - self._at
        self._file.seek(self._at)
        found = self._file.read(left if size < 0 else min(size, left))
        self._at += len(found)
        return found


def _stream(file: BinaryIO, head: ChunkHead) -> _Source:
    """What a chunk unpacks to, from its beginning."""
    packed = _Stretch(file, head.data_bytes, head.end_bytes)
    if head.compression == "zstd":
        return zstandard.ZstdDecompressor().stream_reader(packed)  # type: ignore[arg-type]
    if head.compression == "lz4":
        return _Lz4Stream(packed)
    return packed


class _Lz4Stream:
    """Unpacks lz4 piece by piece."""

    def __init__(self, packed: _Stretch) -> None:
        self._packed = packed
        self._decompressor = lz4.frame.LZ4FrameDecompressor()

    def read(self, size: int, /) -> bytes:
        while not self._decompressor.eof:
            wanted = self._decompressor.needs_input
            data = self._packed.read(PIECE_BYTES) if wanted else b""
            found = bytes(self._decompressor.decompress(data, max_length=size))
            if found or (wanted and not data):
                return found
        return b""


def verify_large(file: BinaryIO, head: ChunkHead) -> None:
    """Unpack a chunk in pieces and keep none of them; DamagedChunkError if it is not what its head says."""
    source, size_bytes, crc = _stream(file, head), 0, 0
    try:
        while size_bytes <= head.unpacked_bytes and (piece := source.read(PIECE_BYTES)):
            size_bytes, crc = size_bytes + len(piece), zlib.crc32(piece, crc)
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise DamagedChunkError(f"a chunk cannot be unpacked ({error})") from error
    _verify(head, size_bytes, crc)


def large_records(file: BinaryIO, frame: Frame, head: ChunkHead) -> Iterator[Record | int]:
    """The records of a verified chunk, one by one; the size of one that is too large, in its place."""
    source = _stream(file, head)
    while header := _read(source, RECORD_HEADER.size):
        if len(header) < RECORD_HEADER.size:
            raise DamagedChunkError("a chunk ends within a record")
        opcode, length = RECORD_HEADER.unpack(header)
        if length <= MAX_RECORD_BYTES:
            body = _read(source, length)
            if len(body) < length:
                raise DamagedChunkError("a chunk ends within a record")
            yield Record(opcode, frame.offset_bytes, body)
            continue
        for at in range(0, length, PIECE_BYTES):
            _read(source, min(PIECE_BYTES, length - at))
        yield length


def _read(source: _Source, size: int) -> bytes:
    """So many bytes, or as many as there are."""
    parts: list[bytes] = []
    while size > 0 and (part := source.read(size)):
        parts.append(part)
        size -= len(part)
    return b"".join(parts)


class Definition(NamedTuple):
    """Any other record of a chunk: a schema or a channel, undecoded."""

    opcode: int
    body: bytes


@dataclass
class ChunkRecords:
    """What a chunk holds: its schemas and channels, and the messages of each channel in order."""

    definitions: list[Definition] = field(default_factory=list)
    entries: dict[int, list[Entry]] = field(default_factory=dict)


def places(records: bytes) -> Iterator[tuple[int, int, int]]:
    """Of each record of an unpacked chunk: its kind, and where its contents begin and end."""
    header, at, end = RECORD_HEADER.unpack_from, 0, len(records)
    while at < end:
        if at + RECORD_HEADER.size > end:
            raise DamagedChunkError("a chunk ends within a record")
        opcode, length = header(records, at)
        body, at = at + RECORD_HEADER.size, at + RECORD_HEADER.size + length
        if at > end or not opcode or (opcode == MESSAGE and length < _MESSAGE.size):
            raise DamagedChunkError("a chunk holds a record of an impossible kind or length")
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
