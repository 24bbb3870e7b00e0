"""The writer of logs. What it writes has a checksum everywhere, and can be read up to its last chunk.

Schemas and channels stand in the chunks, whose checksums vouch for them even where the index is lost.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import BinaryIO

from small_mcap import CompressionType, McapWriter
from small_mcap.records import Channel, McapRecord, Schema

from swarm.logs.chain import CHAIN, CONTINUES, Chain, first_link

CHUNK_BYTES = 256 * 1024


class LogWriter(McapWriter):
    """Writes into a file from its beginning; `finish` writes the index."""

    def __init__(self, file: BinaryIO) -> None:
        super().__init__(file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._file = file
        self._chain = Chain()
        self.start(profile="", library="swarm-runtime")

    def add_metadata(self, name: str, metadata: dict[str, str]) -> None:
        """As MCAP has it; the chain begins where the log is said to go on from."""
        if name == CONTINUES and self._chain.chunks == 0:
            self._chain = Chain(first_link({name: metadata}))
        super().add_metadata(name, metadata)

    def finish(self) -> None:
        """Write the last link of the chain, and the index."""
        self.end_chunk()
        self.add_metadata(CHAIN, self._chain.record())
        super().finish()

    def messages_by_channel(self) -> Mapping[int, int]:
        """How many messages each channel has in the chunks that are written."""
        return self.statistics.channel_message_counts

    def end_chunk(self) -> None:
        """Write the chunk that is open, if it holds a message."""
        self._finalize_current_chunk()

    def lay_down(self) -> int:
        """Write the open chunk as it is now, to be overwritten by what is written next; where it ends."""
        assert self.chunk_builder is not None
        place, chunk = self._file.tell(), self.chunk_builder.finalize()
        if chunk is None:
            return place
        end = place + chunk[0].write_record_to(self._file)
        self._file.flush()
        self._file.seek(place)
        return end

    def _submit_or_write_chunk(self) -> None:
        assert self.chunk_builder is not None
        self._chain.add(self.chunk_builder.buffer.getvalue())
        super()._submit_or_write_chunk()

    def _write_record(self, record: McapRecord) -> None:
        if isinstance(record, Schema | Channel) and self.chunk_builder is not None:
            self.chunk_builder.buf_pos += record.write_record_to(self.chunk_builder.buffer)
        else:
            super()._write_record(record)
