"""What travels beside every payload: who started sending when, how many messages ago, at what time."""

from __future__ import annotations

import struct
from typing import NamedTuple

_LAYOUT = struct.Struct("<QQq")


class Header(NamedTuple):
    """A sender's epoch (new at each start of its process), a number that counts the messages of one
    key from 1 within an epoch, and the run's time of publishing. Gaps, duplicates and restarts show.
    """

    epoch: int
    sequence: int
    t_ns: int

    def pack(self) -> bytes:
        """24 bytes, little-endian: u64 epoch, u64 sequence, i64 t_ns."""
        return _LAYOUT.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> Header | None:
        """The header, or None if the bytes are no header."""
        return cls(*_LAYOUT.unpack(data)) if len(data) == _LAYOUT.size else None


class Item(NamedTuple):
    """One message as it travels, undecoded. Items sort by key, epoch and sequence."""

    key: str
    header: Header
    payload: bytes
