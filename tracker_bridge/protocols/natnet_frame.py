"""NatNet's FrameOfData: everything that the cameras saw at one moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from struct import Struct
from typing import TypeVar

from tracker_bridge.protocols.cursor import (
    F32,
    I32,
    U16,
    U32,
    Cursor,
    DatagramError,
    Quaternion,
    Vector,
    finite,
)
from tracker_bridge.protocols.natnet import Version

F64 = Struct("<d")
BODY = Struct("<i3f4f")
TICKS = Struct("<3Q")
TIMECODE = Struct("<2I")
PRECISE_TIME = Struct("<2I")
AFTER_TIMES = Struct("<Hi")
"""The frame's parameters and the end mark."""

TRACKED = 1
OCCLUDED, POINT_CLOUD_SOLVED, MODEL_SOLVED = 1, 2, 4
RECORDING, MODELS_CHANGED = 1, 2

LONGEST_S = 4e9
"""A timestamp counts seconds since the server began, or since 1970; in nanoseconds it fits in 63 bits."""
QUATERNION_SLACK = 0.01
"""f32 quaternions are of length 1 within 1e-6; a packet read with a wrong layout is far from it."""

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class MarkerSet:
    """A named group of markers, in metres."""

    name: str
    positions_m: tuple[Vector, ...]


@dataclass(frozen=True, slots=True)
class RigidBody:
    """A rigid body, in metres and in the axes that Motive streams."""

    id: int
    position_m: Vector
    rotation: Quaternion
    error_m: float
    """The mean distance of its markers from where they should be."""
    tracked: bool
    """Before 2.6 it is not sent: then a body that stands exactly at the origin counts as lost."""


@dataclass(frozen=True, slots=True)
class LabelledMarker:
    """A marker that the system follows; `body` is 0 if it belongs to none."""

    id: int
    body: int
    position_m: Vector
    size_m: float
    occluded: bool = False
    point_cloud_solved: bool = False
    model_solved: bool = False
    residual_m: float = 0.0


@dataclass(frozen=True)
class Frame:
    """One frame; ticks are of the server's clock, 0 before version 3.0."""

    number: int
    marker_sets: tuple[MarkerSet, ...] = ()
    other_markers_m: tuple[Vector, ...] = ()
    rigid_bodies: tuple[RigidBody, ...] = ()
    skeletons: dict[int, tuple[RigidBody, ...]] = field(default_factory=dict)
    labelled_markers: tuple[LabelledMarker, ...] = ()
    timestamp_s: float = 0.0
    mid_exposure_ticks: int = 0
    transmit_ticks: int = 0
    recording: bool = False
    models_changed: bool = False
    bytes_left: int = 0

    def shares_seen(self) -> dict[int, float]:
        """Of each body that has labelled markers, the share that was not occluded."""
        seen: dict[int, list[bool]] = {}
        for marker in self.labelled_markers:
            seen.setdefault(marker.body, []).append(not marker.occluded)
        return {body: sum(each) / len(each) for body, each in seen.items()}


def parse_frame(payload: bytes, version: Version) -> Frame:
    """DatagramError if the payload cannot be a frame of that version."""
    return _FrameReader(Cursor(payload), version).frame()


class _FrameReader:
    """Goes through a frame once; every section depends on the version."""

    def __init__(self, cursor: Cursor, version: Version) -> None:
        self._cursor = cursor
        self._version = version

    def frame(self) -> Frame:
        number = self._cursor.number(I32)
        marker_sets = self._section(9, self._marker_set)
        others = self._section(12, self._cursor.vector)
        bodies = self._section(BODY.size, self._body)
        skeletons = dict(self._section(8, self._skeleton))
        if self._version >= (4, 1):
            self._skip_section()
        markers = self._section(20, self._labelled_marker)
        self._pass_analog_data()
        timestamp_s, mid_exposure, transmit = self._times()
        flags = self._end()
        return Frame(
            number,
            marker_sets,
            others,
            bodies,
            skeletons,
            markers,
            timestamp_s,
            mid_exposure,
            transmit,
            recording=bool(flags & RECORDING),
            models_changed=bool(flags & MODELS_CHANGED),
            bytes_left=self._cursor.left,
        )

    def _pass_analog_data(self) -> None:
        """Force plates from 2.9 on, devices from 3.0 on; before 3.0, the server's latency."""
        if self._version >= (2, 9):
            self._channels()
        if self._version >= (3, 0):
            self._channels()
        else:
            self._cursor.take(F32)

    def _section(self, smallest_bytes: int, entry: Callable[[], T]) -> tuple[T, ...]:
        """A list; from 4.1 on its size in bytes stands behind the count, and has to be right."""
        count = self._cursor.count(smallest_bytes)
        if self._version < (4, 1):
            return tuple(entry() for _ in range(count))
        size = self._cursor.number(U32)
        before = self._cursor.left
        entries = tuple(entry() for _ in range(count))
        if before - self._cursor.left != size:
            raise DatagramError("a section of another size")
        return entries

    def _skip_section(self) -> None:
        """From 4.1 on, what nobody here needs is passed over by its size."""
        self._cursor.count(1)
        self._cursor.block(self._cursor.number(U32))

    def _channels(self) -> None:
        """Force plates or devices: ids with channels of numbers, of no use here."""
        if self._version >= (4, 1):
            self._skip_section()
            return
        for _ in range(self._cursor.count(8)):
            self._cursor.take(I32)
            for _ in range(self._cursor.count(4)):
                self._cursor.block(4 * self._cursor.count(4))

    def _marker_set(self) -> MarkerSet:
        name = self._cursor.text()
        return MarkerSet(name, tuple(self._cursor.vector() for _ in range(self._cursor.count(12))))

    def _body(self) -> RigidBody:
        number, *numbers = self._cursor.take(BODY)
        if self._version < (3, 0):
            self._cursor.block(20 * self._cursor.count(20))
        error_m = self._cursor.number(F32)
        position_m, rotation = tuple(numbers[:3]), tuple(numbers[3:])
        tracked = any(position_m)
        if self._version >= (2, 6):
            tracked = bool(self._cursor.number(U16) & TRACKED)
        if tracked and not _is_pose(position_m, rotation, error_m):
            raise DatagramError("a body that is tracked but has no pose")
        return RigidBody(number, position_m, rotation, error_m, tracked)

    def _skeleton(self) -> tuple[int, tuple[RigidBody, ...]]:
        number = self._cursor.number(I32)
        return number, tuple(self._body() for _ in range(self._cursor.count(BODY.size)))

    def _labelled_marker(self) -> LabelledMarker:
        """Its label: body and marker in one number from 2.9 on, before that the marker alone."""
        label: int = self._cursor.number(U32)
        body, marker = (label >> 16, label & 0xFFFF) if self._version >= (2, 9) else (0, label)
        position_m, size_m = self._cursor.vector(), self._cursor.number(F32)
        flags = self._cursor.number(U16) if self._version >= (2, 6) else 0
        residual_m = self._cursor.number(F32) if self._version >= (3, 0) else 0.0
        solved = bool(flags & POINT_CLOUD_SOLVED), bool(flags & MODEL_SOLVED)
        return LabelledMarker(marker, body, position_m, size_m, bool(flags & OCCLUDED), *solved, residual_m)

    def _times(self) -> tuple[float, int, int]:
        """Behind the timecode: the server's seconds, and its ticks at mid-exposure and at sending."""
        self._cursor.take(TIMECODE)
        timestamp_s = self._cursor.number(F64 if self._version >= (2, 7) else F32)
        if not 0.0 <= timestamp_s <= LONGEST_S:
            raise DatagramError("a time that cannot be")
        if self._version < (3, 0):
            return timestamp_s, 0, 0
        mid_exposure, _, transmit = self._cursor.take(TICKS)
        return timestamp_s, mid_exposure, transmit

    def _end(self) -> int:
        """The flags. From 4.1 on a server may put a time of its network's clock (PTP) before them."""
        if self._version >= (4, 1) and self._cursor.left >= PRECISE_TIME.size + AFTER_TIMES.size:
            self._cursor.take(PRECISE_TIME)
        if self._version < (2, 6):
            self._cursor.take(I32)
            return 0
        flags: int = self._cursor.take(AFTER_TIMES)[0]
        return flags


def _is_pose(position_m: tuple[float, ...], rotation: tuple[float, ...], error_m: float) -> bool:
    length_squared = sum(part * part for part in rotation)
    return finite((*position_m, error_m)) and abs(length_squared - 1.0) < QUATERNION_SLACK
