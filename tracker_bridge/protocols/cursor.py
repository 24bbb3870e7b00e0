"""Reads a datagram from front to back and never past its end."""

from __future__ import annotations

import math
from struct import Struct
from typing import Any

U8 = Struct("<B")
U16 = Struct("<H")
I32 = Struct("<i")
U32 = Struct("<I")
F32 = Struct("<f")
VECTOR = Struct("<3f")

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""


class DatagramError(ValueError):
    """Bytes that are not what they should be. There are few texts, so that refusals are counted by them."""


class Cursor:
    """A place in some bytes; every step forward is checked against their end."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    @property
    def left(self) -> int:
        """Bytes not yet read."""
        return len(self._data) - self._at

    def take(self, layout: Struct) -> tuple[Any, ...]:
        if layout.size > self.left:
            raise DatagramError("cut short")
        values = layout.unpack_from(self._data, self._at)
        self._at += layout.size
        return values

    def number(self, layout: Struct) -> Any:
        """The one value of a layout."""
        return self.take(layout)[0]

    def vector(self) -> Vector:
        x, y, z = self.take(VECTOR)
        return x, y, z

    def count(self, smallest_bytes: int, layout: Struct = U32) -> int:
        """How many entries follow; no more than the bytes that are left can hold."""
        count: int = self.number(layout)
        if not 0 <= count * smallest_bytes <= self.left:
            raise DatagramError("more entries than bytes")
        return count

    def text(self) -> str:
        """UTF-8 up to a zero byte, which is passed over."""
        end = self._data.find(b"\0", self._at)
        if end < 0:
            raise DatagramError("a name without end")
        raw, self._at = self._data[self._at : end], end + 1
        return decoded(raw)

    def block(self, size: int) -> bytes:
        """Bytes as they are."""
        if not 0 <= size <= self.left:
            raise DatagramError("cut short")
        self._at += size
        return self._data[self._at - size : self._at]


def decoded(raw: bytes) -> str:
    """A name; DatagramError if it is not printable UTF-8."""
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError as error:
        raise DatagramError("a name that is no text") from error
    if not text.isprintable():
        raise DatagramError("a name that is no text")
    return text


def fixed_text(raw: bytes) -> str:
    """A name in a field of fixed size, filled up with zeros."""
    return decoded(raw.partition(b"\0")[0])


def finite(values: tuple[float, ...]) -> bool:
    return all(map(math.isfinite, values))
