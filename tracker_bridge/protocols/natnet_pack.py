"""NatNet's frames and model definitions as bytes, for emulators."""

from __future__ import annotations

from collections.abc import Iterable
from struct import pack

from tracker_bridge.protocols.natnet import Version
from tracker_bridge.protocols.natnet_frame import (
    AFTER_TIMES,
    BODY,
    F64,
    MODELS_CHANGED,
    OCCLUDED,
    POINT_CLOUD_SOLVED,
    PRECISE_TIME,
    TICKS,
    TIMECODE,
    TRACKED,
    Frame,
    LabelledMarker,
    RigidBody,
)
from tracker_bridge.protocols.natnet_models import RIGID_BODY, BodyDefinition

END_OF_DATA = 0


def pack_frame(frame: Frame, version: Version) -> bytes:
    """The payload of a frame without marker sets, skeletons, force plates and devices."""
    payload = pack("<i", frame.number)
    payload += _section(version, [])
    payload += _section(version, [pack("<3f", *marker) for marker in frame.other_markers_m])
    payload += _section(version, [_body(body, version) for body in frame.rigid_bodies])
    payload += _section(version, [])
    if version >= (4, 1):
        payload += _section(version, [])
    payload += _section(version, [_marker(marker, version) for marker in frame.labelled_markers])
    if version >= (2, 9):
        payload += _section(version, [])
    payload += _section(version, []) if version >= (3, 0) else pack("<f", frame.timestamp_s)
    return payload + _times(frame, version)


def pack_models(bodies: Iterable[BodyDefinition], version: Version) -> bytes:
    """The payload of the definitions of rigid bodies."""
    packed = []
    for body in bodies:
        block = _definition(body, version)
        size = pack("<I", len(block)) if version >= (4, 1) else b""
        packed.append(pack("<I", RIGID_BODY) + size + block)
    return pack("<I", len(packed)) + b"".join(packed)


def _section(version: Version, entries: list[bytes]) -> bytes:
    block = b"".join(entries)
    size = pack("<I", len(block)) if version >= (4, 1) else b""
    return pack("<I", len(entries)) + size + block


def _body(body: RigidBody, version: Version) -> bytes:
    packed = BODY.pack(body.id, *body.position_m, *body.rotation)
    packed += pack("<I", 0) if version < (3, 0) else b""
    packed += pack("<f", body.error_m)
    return packed + (pack("<H", TRACKED if body.tracked else 0) if version >= (2, 6) else b"")


def _marker(marker: LabelledMarker, version: Version) -> bytes:
    label = marker.body << 16 | marker.id if version >= (2, 9) else marker.id
    packed = pack("<I3ff", label, *marker.position_m, marker.size_m)
    flags = OCCLUDED * marker.occluded | POINT_CLOUD_SOLVED * marker.point_cloud_solved
    packed += pack("<H", flags) if version >= (2, 6) else b""
    return packed + (pack("<f", marker.residual_m) if version >= (3, 0) else b"")


def _times(frame: Frame, version: Version) -> bytes:
    packed = TIMECODE.pack(0, 0)
    packed += F64.pack(frame.timestamp_s) if version >= (2, 7) else pack("<f", frame.timestamp_s)
    if version >= (3, 0):
        packed += TICKS.pack(frame.mid_exposure_ticks, frame.mid_exposure_ticks, frame.transmit_ticks)
    if version >= (4, 1):
        packed += PRECISE_TIME.pack(0, 0)
    if version < (2, 6):
        return packed + pack("<i", END_OF_DATA)
    return packed + AFTER_TIMES.pack(MODELS_CHANGED * frame.models_changed, END_OF_DATA)


def _definition(body: BodyDefinition, version: Version) -> bytes:
    packed = body.name.encode() + b"\0" + pack("<2i3f", body.id, -1, *body.offset_m)
    if version < (3, 0):
        return packed
    markers = body.markers_m
    packed += pack("<I", len(markers)) + b"".join(pack("<3f", *marker) for marker in markers)
    packed += pack(f"<{len(markers)}I", *([0] * len(markers)))
    if version >= (4, 0):
        packed += b"".join(f"Marker {number}".encode() + b"\0" for number in range(1, len(markers) + 1))
    return packed
