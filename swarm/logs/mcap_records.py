"""The records of an MCAP file: how they are framed, and those that are decoded here."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from typing import Any, BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    ChunkIndex,
    Footer,
    Message,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)

MAGIC = b"\x89MCAP0\r\n"
MAX_RECORD_BYTES = 64 * 1024 * 1024
"""No larger record is held in memory: it is read in pieces, or passed over and said so."""
PIECE_BYTES = 1024 * 1024
LAST_OPCODE = 0x0F
"""Data end. What follows up to 0x7F is reserved, from 0x80 private; 0 is no record."""
RECORD_HEADER = struct.Struct("<BQ")
FOOTER_BYTES = 20
"""Of its contents: where the index and its table begin, and the index's checksum."""
CRC = struct.Struct("<I")


class BrokenRecordError(ValueError):
    """Contents that cannot be trusted; the text says why."""


class FramingError(ValueError):
    """The records cannot be followed any further than `offset_bytes`; the text says why."""

    def __init__(self, reason: str, offset_bytes: int) -> None:
        super().__init__(reason)
        self.offset_bytes = offset_bytes


class Frame(NamedTuple):
    """A record's kind, and where in the file it begins, its contents begin, and it ends."""

    opcode: int
    offset_bytes: int
    body_bytes: int
    end_bytes: int

    @property
    def length_bytes(self) -> int:
        """Of its contents."""
        return self.end_bytes - self.body_bytes


class Record(NamedTuple):
    """A record's kind, the place in the file where it, or its chunk, begins, and its contents.

    Of a chunk the contents are the records in it, unpacked and verified; of an attachment that is larger
    than any record may be there are none.
    """

    opcode: int
    offset_bytes: int
    body: bytes


def size_of(file: BinaryIO) -> int:
    """How many bytes an open file has."""
    return os.fstat(file.fileno()).st_size


def frame_at(file: BinaryIO, offset_bytes: int, size_bytes: int) -> Frame:
    """The record that begins at a place; FramingError if none can begin there."""
    file.seek(min(offset_bytes, size_bytes))
    header = file.read(RECORD_HEADER.size)
    if len(header) < RECORD_HEADER.size:
        raise FramingError("the log is cut short here", offset_bytes)
    opcode, length = RECORD_HEADER.unpack(header)
    if opcode == 0:
        raise FramingError("no record begins here", offset_bytes)
    body = offset_bytes + RECORD_HEADER.size
    if body + length > size_bytes:
        raise FramingError("the log is cut short here, within a record", offset_bytes)
    return Frame(opcode, offset_bytes, body, body + length)


def is_frame(file: BinaryIO, offset_bytes: int, size_bytes: int) -> bool:
    """Whether a record of a known kind may begin at a place."""
    try:
        return frame_at(file, offset_bytes, size_bytes).opcode <= LAST_OPCODE
    except FramingError:
        return False


def pieces(file: BinaryIO, begin_bytes: int, end_bytes: int) -> Iterator[bytes]:
    """A stretch of a file in pieces of a bounded size."""
    file.seek(begin_bytes)
    while begin_bytes < end_bytes:
        piece = file.read(min(PIECE_BYTES, end_bytes - begin_bytes))
        if not piece:
            return
        begin_bytes += len(piece)
        yield piece


def crc_of(file: BinaryIO, begin_bytes: int, end_bytes: int, crc: int = 0) -> int:
    """CRC-32 of a stretch of a file, going on from that of what stands before it."""
    for piece in pieces(file, begin_bytes, end_bytes):
        crc = zlib.crc32(piece, crc)
    return crc


BROKEN = (McapError, BrokenRecordError, ValueError, OverflowError, struct.error)
"""What a damaged record raises when it is decoded."""
_READ: dict[int, Any] = {
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.METADATA: Metadata.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.FOOTER: Footer.read,
    Opcode.CHUNK_INDEX: ChunkIndex.read,
    Opcode.METADATA_INDEX: MetadataIndex.read,
}


def decoded(opcode: int, body: bytes) -> object:
    """A record of a kind that is needed here; None for any other. BrokenRecordError says what is wrong."""
    stream = ReadDataStream(BytesIO(body))
    try:
        if opcode == Opcode.MESSAGE:
            return Message.read(stream, len(body))
        read = _READ.get(opcode)
        return read(stream) if read else None
    except (McapError, ValueError, OverflowError, struct.error, MemoryError) as error:
        detail = str(error)[:80] or type(error).__name__
        raise BrokenRecordError(f"a {kind(opcode)} record makes no sense ({detail})") from error


def kind(opcode: int) -> str:
    """The name of a kind of record, for people."""
    names = {int(known): known.name for known in Opcode}
    return names.get(opcode, f"0x{opcode:02x}").lower().replace("_", " ")
