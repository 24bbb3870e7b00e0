"""A way through an MCAP file that finds every record which is whole, and notes every place which is not.

Where the records can be followed no further, the way goes on at the next chunk that is whole. Such chunks
are found by the index, which is not believed, and by looking for what a chunk's head looks like.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from heapq import merge
from typing import BinaryIO

from mcap.opcode import Opcode

from swarm.logs.mcap_chunks import chunk_head, large_records, unpack, verify_large
from swarm.logs.mcap_index import footer_of, is_footer, read_index
from swarm.logs.mcap_records import (
    BROKEN,
    CRC,
    MAGIC,
    MAX_RECORD_BYTES,
    PIECE_BYTES,
    BrokenRecordError,
    Frame,
    FramingError,
    Record,
    crc_of,
    frame_at,
    is_frame,
    kind,
    size_of,
)

_BARE = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA, Opcode.MESSAGE)
_CHUNK_HEAD = re.compile(
    rb"(?=\x06.{5}\x00{3}.{28}(?:\x00{4}|\x03\x00{3}lz4|\x04\x00{3}zstd))",
    re.DOTALL,
)
"""A chunk's opcode, a length below 2^40, times, size and checksum, and one of the three compressions."""
_CHUNK_HEAD_BYTES = 64
"""More than that pattern is long: as much of a piece is looked at again with the next one."""


class Walk:
    """Goes once through a file, from front to back.

    `note` is told of each damaged place and why; `wanted` are the kinds of records that are read at all, with
    nothing else of the file, so that nothing is verified then. None: all of them.
    """

    def __init__(
        self, file: BinaryIO, note: Callable[[int, str], None], wanted: Collection[int] | None = None
    ) -> None:
        self._file = file
        self._note = note
        self._wanted = wanted
        self._size = size_of(file)
        self.index = read_index(file)
        self.unverified: list[str] = []
        """What no checksum vouches for."""
        self._followed = True
        """Whether every record so far made sense."""
        self._trusted = len(MAGIC)
        """Nothing that has not been given yet stands before."""
        self._data_end: int | None = None

    def records(self) -> Iterator[Record]:
        """Schemas, channels, messages, chunks, attachments and metadata; FramingError for what is no log."""
        self._file.seek(0)
        if self._file.read(len(MAGIC)) != MAGIC:
            raise FramingError("is not an MCAP log: it does not begin like one", 0)
        offset = len(MAGIC)
        while offset < self._size or self._followed:
            try:
                frame = frame_at(self._file, offset, self._size)
                if frame.opcode == Opcode.FOOTER and self._is_end(frame):
                    return
                yield from self._of(frame)
                offset = frame.end_bytes
            except FramingError as error:
                self._lost(error.offset_bytes, str(error))
                offset = self._next_whole(self._trusted, max(offset, error.offset_bytes) + 1)
            except BROKEN as error:
                self._lost(offset, str(error))
                offset = self._after_broken(frame)

    def _lost(self, offset: int, reason: str) -> None:
        self._followed = False
        self._note(offset, reason)

    def _of(self, frame: Frame) -> Iterator[Record]:
        """What a record gives. One of a kind that is not wanted is passed over."""
        if self._wanted is not None and frame.opcode not in self._wanted:
            self._trusted = frame.offset_bytes + 1
        elif frame.opcode == Opcode.DATA_END:
            self._end_data(frame)
        elif frame.opcode == Opcode.CHUNK:
            yield from self._of_chunk(frame)
        elif frame.opcode == Opcode.ATTACHMENT:
            yield self._attachment(frame)
        elif frame.opcode in _BARE and self._data_end is None:
            # The index repeats schemas and channels: what comes after the data is not taken for data.
            yield from self._bare(frame)

    def _bare(self, frame: Frame) -> Iterator[Record]:
        """A record that stands in no chunk."""
        if frame.length_bytes > MAX_RECORD_BYTES:
            self._pass_over(frame)
        else:
            yield Record(frame.opcode, frame.offset_bytes, self._read(frame))
        self._trusted = frame.offset_bytes + 1

    def _read(self, frame: Frame) -> bytes:
        self._file.seek(frame.body_bytes)
        return self._file.read(frame.length_bytes)

    def _of_chunk(self, frame: Frame) -> Iterator[Record]:
        head = chunk_head(self._file, frame)
        if not head.is_large:
            yield Record(Opcode.CHUNK, frame.offset_bytes, unpack(self._file, head))
        else:
            verify_large(self._file, head)
            for found in large_records(self._file, frame, head):
                if isinstance(found, Record):
                    yield found
                else:
                    self._note(frame.offset_bytes, _too_large(found))
        self._trusted = frame.end_bytes

    def _attachment(self, frame: Frame) -> Record:
        """An attachment, if its checksum is right or it has none."""
        if frame.length_bytes < CRC.size:
            raise BrokenRecordError("an attachment is too short")
        crc = crc_of(self._file, frame.body_bytes, frame.end_bytes - CRC.size)
        stored = CRC.unpack(self._file.read(CRC.size))[0]
        if stored not in (0, crc):
            raise BrokenRecordError("an attachment's checksum (CRC) is wrong")
        large = frame.length_bytes > MAX_RECORD_BYTES
        return Record(frame.opcode, frame.offset_bytes, b"" if large else self._read(frame))

    def _pass_over(self, frame: Frame) -> None:
        if not is_frame(self._file, frame.end_bytes, self._size):
            name = kind(frame.opcode)
            raise BrokenRecordError(f"a {name} record of {frame.length_bytes} bytes leads nowhere")
        self._note(frame.offset_bytes, _too_large(frame.length_bytes))

    def _end_data(self, frame: Frame) -> None:
        """Verify the checksum over everything before."""
        if frame.length_bytes != CRC.size:
            raise BrokenRecordError("an end of the data of a wrong length")
        stored = CRC.unpack(self._read(frame))[0]
        self._data_end = frame.end_bytes
        if stored == 0:
            self.unverified.append("the log has no checksum (CRC) over all records: damage would not show")
        elif crc_of(self._file, 0, frame.offset_bytes) != stored:
            self._lost(frame.offset_bytes, "the checksum (CRC) over all records is wrong")

    def _is_end(self, frame: Frame) -> bool:
        """Whether a footer is the one at the file's end; what is wrong with the end is noted."""
        after = frame.end_bytes + len(MAGIC)
        self._file.seek(frame.end_bytes)
        magic = self._file.read(len(MAGIC))
        if not is_footer(frame) or (magic != MAGIC and after < self._size):
            raise BrokenRecordError("a footer that is not at the log's end")
        if magic != MAGIC:
            self._lost(frame.end_bytes, "the log does not end as an MCAP log should")
        elif after < self._size:
            self._lost(after, f"{self._size - after} bytes after the log's end")
        elif self._wanted is None:
            self._check_end(frame)
        return True

    def _check_end(self, frame: Frame) -> None:
        """What the footer says of the index, against what was found."""
        begin = footer_of(self._file, frame).summary_start or frame.offset_bytes
        if self._data_end is None:
            self._note(frame.offset_bytes, "the end of the data is not marked")
        elif begin != self._data_end:
            self._note(frame.offset_bytes, "the index does not begin where the footer says")
        if self.index.fault:
            self._note(frame.offset_bytes, self.index.fault)
        if not self.index.verified and not self.index.fault:
            self.unverified.append("the index has no checksum (CRC): damage to it would not show")

    def _after_broken(self, frame: Frame) -> int:
        """Where to go on after a record that makes no sense: its length may be wrong, too."""
        follows = is_frame(self._file, frame.end_bytes, self._size)
        if follows and frame.opcode != Opcode.CHUNK:
            return frame.end_bytes
        inside = self._next_whole(frame.offset_bytes, frame.offset_bytes + 1, frame.end_bytes)
        if inside < frame.end_bytes or follows:
            return inside
        return self._next_whole(frame.end_bytes, frame.end_bytes)

    def _next_whole(self, begin: int, lost: int, end: int | None = None) -> int:
        """The first chunk from `begin` on that is whole, or the first metadata that a sound index knows
        behind what is lost; `end`, or else the file's size, if there is none before it.
        """
        end = self._size if end is None else end
        known = self.index.metadata if self.index.verified else []
        hints = [offset for offset in self.index.chunks if offset >= begin]
        hints += [offset for offset in known if offset >= lost]
        for offset in merge(sorted(hints), self._like_chunks(begin, end)):
            if offset < end and (offset in known or self._is_whole(offset)):
                return offset
        return end

    def _like_chunks(self, begin: int, end: int) -> Iterator[int]:
        """Places where the bytes look like a chunk's head."""
        while begin < end:
            self._file.seek(begin)
            piece = self._file.read(min(PIECE_BYTES, end - begin) + _CHUNK_HEAD_BYTES)
            for match in _CHUNK_HEAD.finditer(piece):
                if match.start() < PIECE_BYTES:
                    yield begin + match.start()
            begin += PIECE_BYTES

    def _is_whole(self, offset: int) -> bool:
        """Whether a chunk begins here whose contents are what its head says."""
        try:
            frame = frame_at(self._file, offset, self._size)
            head = chunk_head(self._file, frame)
            verify_large(self._file, head)
        except (*BROKEN, FramingError):
            return False
        return frame.opcode == Opcode.CHUNK


def _too_large(length_bytes: int) -> str:
    return f"a record of {length_bytes} bytes is left out; at most {MAX_RECORD_BYTES} are read"
