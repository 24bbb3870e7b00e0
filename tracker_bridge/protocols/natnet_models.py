"""NatNet's model definitions: which rigid body has which name."""

from __future__ import annotations

from dataclasses import dataclass
from struct import Struct

from tracker_bridge.protocols.cursor import F32, I32, U32, Cursor, Vector
from tracker_bridge.protocols.natnet import Version

MARKER_SET, RIGID_BODY, SKELETON, FORCE_PLATE, DEVICE, CAMERA = range(6)

_IDS = Struct("<2i")
_FORCE_PLATE = Struct("<2f3f144f12f2i")
"""Width, length, origin, calibration matrix of 12 x 12, four corners, type, data type."""


@dataclass(frozen=True)
class BodyDefinition:
    """A rigid body as it was defined in Motive."""

    id: int
    name: str
    offset_m: Vector = (0.0, 0.0, 0.0)
    markers_m: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class Models:
    """The definitions that matter here; `bytes_left` is 0 if every one could be read."""

    bodies: dict[int, BodyDefinition]
    """By the number that frames call them by."""
    marker_sets: dict[str, tuple[str, ...]]
    bytes_left: int = 0

    def name_of(self, body: int) -> str:
        """A body's name; its number if there is none."""
        return self.bodies[body].name if body in self.bodies else str(body)


def parse_models(payload: bytes, version: Version) -> Models:
    """DatagramError if the payload cannot be definitions of that version.

    Before 4.1 nothing tells the size of a kind that is not known: reading ends there.
    """
    cursor = Cursor(payload)
    bodies: dict[int, BodyDefinition] = {}
    marker_sets: dict[str, tuple[str, ...]] = {}
    for _ in range(cursor.count(5)):
        kind = cursor.number(U32)
        block = Cursor(cursor.block(cursor.number(U32))) if version >= (4, 1) else cursor
        if kind == MARKER_SET:
            name = block.text()
            marker_sets[name] = tuple(block.text() for _ in range(block.count(1)))
        elif kind == RIGID_BODY:
            body = _body(block, version)
            bodies[body.id] = body
        elif not _passed_over(block, kind, version):
            break
    return Models(bodies, marker_sets, cursor.left)


def _body(cursor: Cursor, version: Version) -> BodyDefinition:
    name = cursor.text()
    number, _ = cursor.take(_IDS)
    offset_m = cursor.vector()
    markers_m: tuple[Vector, ...] = ()
    if version >= (3, 0):
        markers = cursor.count(16)
        markers_m = tuple(cursor.vector() for _ in range(markers))
        cursor.block(4 * markers)
        if version >= (4, 0):
            for _ in range(markers):
                cursor.text()
    return BodyDefinition(number, name, offset_m, markers_m)


def _passed_over(cursor: Cursor, kind: int, version: Version) -> bool:
    """Whether the end of a kind that is of no use here could be found."""
    if version >= (4, 1):
        return True
    if kind == SKELETON:
        _pass_skeleton(cursor, version)
    elif kind == FORCE_PLATE and version >= (3, 0):
        cursor.take(I32)
        cursor.text()
        cursor.take(_FORCE_PLATE)
        _pass_names(cursor)
    elif kind == DEVICE and version >= (3, 0):
        cursor.take(I32)
        cursor.text()
        cursor.text()
        cursor.take(_IDS)
        _pass_names(cursor)
    elif kind == CAMERA:
        cursor.text()
        cursor.block(7 * F32.size)
    else:
        return False
    return True


def _pass_skeleton(cursor: Cursor, version: Version) -> None:
    cursor.text()
    cursor.take(I32)
    for _ in range(cursor.count(20)):
        _body(cursor, version)


def _pass_names(cursor: Cursor) -> None:
    for _ in range(cursor.count(1)):
        cursor.text()
