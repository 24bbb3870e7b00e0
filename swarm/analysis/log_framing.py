"""The outermost layer of a log: its records one after the other, each whole, with its place in the file.

Message indexes, the greater part of a log's records, are stepped over: this reader goes from front to
back and needs none.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode

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
