"""The records of a log that are needed here, decoded."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from io import BytesIO
from typing import Any, BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Message, Metadata, Schema, Statistics

from swarm.analysis.log_chunks import DamagedChunkError
from swarm.analysis.log_framing import summary_records

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
