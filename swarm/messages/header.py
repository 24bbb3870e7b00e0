"""What travels beside every payload: who started sending when, how many messages ago, at what time."""

from __future__ import annotations

import struct
from dataclasses import dataclass

_LAYOUT = struct.Struct("<QQq")


@dataclass(frozen=True, slots=True)
class Header:
    """A sender's epoch (new at each start of its process), a number that counts the messages of one
    key from 1 within an epoch, and the run's time of publishing. Gaps, duplicates and restarts show.
    """

    epoch: int
    sequence: int
    t_ns: int

    def pack(self) -> bytes:
        """24 bytes, little-endian: u64 epoch, u64 sequence, i64 t_ns."""
        return _LAYOUT.pack(self.epoch, self.sequence, self.t_ns)

    @classmethod
    def unpack(cls, data: bytes) -> Header | None:
        """The header, or None if the bytes are no header."""
        return cls(*_LAYOUT.unpack(data)) if len(data) == _LAYOUT.size else None
