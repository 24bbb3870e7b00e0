"""The index at the end of an MCAP file. It repeats what the data say, and never overrules them.

An index whose checksum is right vouches for the schemas, the channels and the places of records, which have
no checksum of their own where they stand. One whose checksum is wrong or missing only hints at places.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Footer, MetadataIndex, Schema, Statistics

from swarm.logs.mcap_records import (
    BROKEN,
    CRC,
    FOOTER_BYTES,
    MAGIC,
    MAX_RECORD_BYTES,
    RECORD_HEADER,
    BrokenRecordError,
    Frame,
    FramingError,
    crc_of,
    decoded,
    frame_at,
    size_of,
)

_END_BYTES = RECORD_HEADER.size + FOOTER_BYTES + len(MAGIC)


@dataclass
class Index:
    """What a file's index says; all of it empty if there is none that can be read."""

    verified: bool = False
    """Whether a checksum shows that it is what was written."""
    definitions: list[Schema | Channel] = field(default_factory=list)
    chunks: list[int] = field(default_factory=list)
    """The places where chunks begin."""
    metadata: list[int] = field(default_factory=list)
    statistics: Statistics | None = None
    fault: str = ""
    """Why it cannot be trusted."""


def read_index(file: BinaryIO) -> Index:
    """The index of a file that ends as an MCAP file should; an empty one of any other file."""
    size, index = size_of(file), Index()
    file.seek(max(0, size - _END_BYTES))
    end = file.read(_END_BYTES)
    try:
        frame = frame_at(file, max(0, size - _END_BYTES), size)
    except FramingError:
        return index
    if len(end) == _END_BYTES and end.endswith(MAGIC) and is_footer(frame):
        try:
            _take_all(index, file, frame)
        except (*BROKEN, FramingError) as error:
            fault = index.fault or f"the index is damaged: {error}"
            return Index(chunks=index.chunks, fault=fault)
    return index


def is_footer(frame: Frame) -> bool:
    """Whether a record has the kind and the length of a footer."""
    return frame.opcode == Opcode.FOOTER and frame.length_bytes == FOOTER_BYTES


def footer_of(file: BinaryIO, frame: Frame) -> Footer:
    """The footer at a place."""
    file.seek(frame.body_bytes)
    found = decoded(Opcode.FOOTER, file.read(FOOTER_BYTES))
    assert isinstance(found, Footer)
    return found


def _take_all(index: Index, file: BinaryIO, end: Frame) -> None:
    """Read every record of the index, even of one that is not known to be sound."""
    footer = footer_of(file, end)
    offset = footer.summary_start or end.offset_bytes
    if offset > end.offset_bytes:
        raise BrokenRecordError("it does not begin where the footer says")
    crc = crc_of(file, offset, end.end_bytes - CRC.size)
    if footer.summary_crc not in (0, crc):
        index.fault = "the index's checksum (CRC) is wrong"
    index.verified = footer.summary_crc == crc
    while offset < end.offset_bytes:
        frame = frame_at(file, offset, end.offset_bytes)
        if frame.length_bytes > MAX_RECORD_BYTES:
            raise BrokenRecordError(f"it holds a record of {frame.length_bytes} bytes")
        file.seek(frame.body_bytes)
        _take(index, decoded(frame.opcode, file.read(frame.length_bytes)))
        offset = frame.end_bytes


def _take(index: Index, record: object) -> None:
    if isinstance(record, Schema | Channel):
        index.definitions.append(record)
    elif isinstance(record, ChunkIndex):
        index.chunks.append(record.chunk_start_offset)
    elif isinstance(record, MetadataIndex):
        index.metadata.append(record.offset)
    elif isinstance(record, Statistics):
        index.statistics = record
