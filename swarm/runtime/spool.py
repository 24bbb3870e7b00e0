"""What must not be lost, on the sender's own disk: a process that was killed may have sent what nobody heard.

A live process keeps its newest messages in memory for a server that missed them (`keeping_publisher`). That
is gone with the process. Its next start sends everything that stands here once more, numbered as it was; the
server takes in what it has not heard.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from contextlib import suppress
from io import BufferedWriter
from pathlib import Path

from swarm.errors import in_words
from swarm.messages.header import Item
from swarm.runtime.lockstep_frames import BAD_FRAME, pack_item, unpack_items

FILE_BYTES = 4 << 20
"""Of each of two files; the older one makes room. In one there are some ten hours of a robot's moves."""
_RECORD = struct.Struct("<II")
"""Length and CRC-32 of a message with its key and header, which follow. Little-endian."""


class Spool:
    """Two files in a directory: NAME.RUN.spool and the older NAME.RUN.spool.old.

    `left` is what earlier starts put there. Other runs' files go: their runs are over. `say` is told once
    if the disk takes no more; the process goes on without.
    """

    def __init__(self, directory: Path, name: str, run_id: str, say: Callable[[str], None]) -> None:
        directory.mkdir(parents=True, exist_ok=True)
        self._path = directory / f"{name}.{run_id}.spool"
        self._old = self._path.with_name(f"{self._path.name}.old")
        for other in directory.glob(f"{name}.*.spool*"):
            if other not in (self._path, self._old):
                other.unlink()
        self._say = say
        self.left = [*_read(self._old), *_read(self._path)]
        self._file: BufferedWriter | None = self._path.open("ab")

    @property
    def epochs(self) -> set[int]:
        """Earlier starts of which messages are left."""
        return {item.header.epoch for item in self.left}

    def put(self, item: Item) -> None:
        """Keep a message; a killed process loses none that was put."""
        if self._file is None:
            return
        body = pack_item(*item)
        try:
            self._file.write(_RECORD.pack(len(body), zlib.crc32(body)) + body)
            self._file.flush()
            if self._file.tell() >= FILE_BYTES:
                self._begin_anew(self._file)
        except OSError as error:
            self._say(f"warning: what is sent is not kept on this disk: {in_words(error)}")
            self._file.raw.close()
            self._file = None

    def close(self) -> None:
        """A second call does nothing."""
        with suppress(OSError):
            if self._file is not None:
                self._file.close()
        self._file = None

    def _begin_anew(self, full: BufferedWriter) -> None:
        full.close()
        self._path.replace(self._old)
        self._file = self._path.open("ab")


def _read(path: Path) -> list[Item]:
    """The messages of a file up to where it is damaged; what follows a torn record goes."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return []
    items: list[Item] = []
    at = 0
    while body := _body_at(data, at):
        try:
            items += unpack_items(body, 0)
        except BAD_FRAME:
            break
        at += _RECORD.size + len(body)
    if at < len(data):
        with path.open("r+b") as file:
            file.truncate(at)
    return items


def _body_at(data: bytes, at: int) -> bytes:
    """The contents of the record at a place; empty if there is no whole one."""
    if at + _RECORD.size > len(data):
        return b""
    length, crc = _RECORD.unpack_from(data, at)
    body = data[at + _RECORD.size : at + _RECORD.size + length]
    return body if len(body) == length and zlib.crc32(body) == crc else b""
