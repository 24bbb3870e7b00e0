"""The insides of a log's chunks: unpacked with a bound on memory, checked, and split fast.

A chunk says how large it is when unpacked. It is never unpacked any further than that, and a chunk that
claims more than `MAX_RECORD_BYTES` is refused, so that no file can fill the memory.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard

from swarm.analysis.log_framing import MAX_RECORD_BYTES

MESSAGE = 0x05
_RECORD = struct.Struct("<BQ")
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
