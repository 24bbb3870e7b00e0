"""Vicon Tracker's UDP object stream ("UDP Object Stream", Vicon Tracker user guide).

    u32 frame number | u8 items | items times: u8 item id, u16 size, that many bytes

Item 0 is an object: 24 bytes of name, f64 x, y, z in millimetres, f64 rotations about x, y, z in radians with
R = Rx Ry Rz. All of it little-endian. A frame of many objects comes in several datagrams of one number, and
senders may fill a datagram up: what counts is the number of items and their sizes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from struct import Struct

from tracker_bridge.protocols.cursor import Cursor, DatagramError, Vector, finite, fixed_text

DEFAULT_PORT = 51001
UNIT_M = 0.001

OBJECT = 0
NAME_BYTES = 24
MOST_ITEMS = 255
"""The number of items is one byte."""

_HEAD = Struct("<IB")
_ITEM_HEAD = Struct("<BH")
_OBJECT = Struct(f"<{NAME_BYTES}s6d")


@dataclass(frozen=True, slots=True)
class ViconObject:
    """An object in the tracker's own axes."""

    name: str
    position_mm: Vector
    rotation_rad: Vector
    """About x, y and z; R = Rx Ry Rz."""

    @property
    def tracked(self) -> bool:
        """An object that is lost is sent as zeros, by some versions, or left out, by others."""
        return any(self.position_mm) or any(self.rotation_rad)


@dataclass(frozen=True, slots=True)
class ViconDatagram:
    """One datagram: a frame, or a part of it."""

    frame: int
    objects: tuple[ViconObject, ...]
    unknown_items: int = 0


def parse(data: bytes) -> ViconDatagram:
    """DatagramError if the bytes are no part of an object stream."""
    cursor = Cursor(data)
    frame, items = cursor.take(_HEAD)
    objects, unknown = [], 0
    for _ in range(items):
        item, size = cursor.take(_ITEM_HEAD)
        block = cursor.block(size)
        if item == OBJECT:
            objects.append(_object(block))
        else:
            unknown += 1
    return ViconDatagram(frame, tuple(objects), unknown)


def _object(block: bytes) -> ViconObject:
    if len(block) != _OBJECT.size:
        raise DatagramError("an object of another size")
    name, *numbers = _OBJECT.unpack(block)
    if not finite(tuple(numbers)):
        raise DatagramError("not a number")
    x, y, z, rx, ry, rz = numbers
    return ViconObject(fixed_text(name), (x, y, z), (rx, ry, rz))


def pack(frame: int, objects: Iterable[ViconObject]) -> bytes:
    """One datagram, for emulators."""
    items = [
        _ITEM_HEAD.pack(OBJECT, _OBJECT.size)
        + _OBJECT.pack(seen.name.encode(), *seen.position_mm, *seen.rotation_rad)
        for seen in objects
    ]
    return _HEAD.pack(frame % 2**32, len(items)) + b"".join(items)
