"""NatNet's bytes: the real packets of three versions, and the vendor's printed values."""

from __future__ import annotations

import math

import natnet as independent
import pytest
from natnet.packet_buffer import PacketBuffer

from tests.support.natnet_capture import packets, printed, single
from tracker_bridge.protocols import natnet
from tracker_bridge.protocols.cursor import DatagramError
from tracker_bridge.protocols.natnet import MessageId, Version
from tracker_bridge.protocols.natnet_frame import Frame, LabelledMarker, RigidBody, parse_frame
from tracker_bridge.protocols.natnet_models import BodyDefinition, parse_models
from tracker_bridge.protocols.natnet_pack import pack_frame, pack_models

PRINTED = 0.005 + 1e-6
"""Two decimals, and the last bit of an f32."""
CLOCK_HZ = 3_312_787


def frame_of(name: str, version: Version) -> Frame:
    number, payload = natnet.split(single(name))
    assert number == MessageId.FRAME
    return parse_frame(payload, version)


def test_every_frame_of_the_capture_says_what_the_vendors_client_printed() -> None:
    frames = {frame.number: frame for frame in map(parsed_3_0, packets(MessageId.FRAME))}
    assert len(frames) == 518
    assert not any(frame.bytes_left for frame in frames.values())
    vendors = printed()
    assert len(vendors) == 251
    for shown in vendors:
        frame = frames[shown.number]
        assert frame.timestamp_s == pytest.approx(shown.timestamp_s, abs=PRINTED)
        latency_ms = (frame.transmit_ticks - frame.mid_exposure_ticks) / CLOCK_HZ * 1000
        assert latency_ms == pytest.approx(shown.system_latency_ms, abs=PRINTED)
        assert len(frame.other_markers_m) == len(shown.others) == 5
        for place, vendors_place in zip(frame.other_markers_m, shown.others, strict=True):
            assert place == pytest.approx(vendors_place, abs=PRINTED)
        for body, (number, valid, error_m, pose) in zip(frame.rigid_bodies, shown.bodies, strict=True):
            assert (body.id, body.tracked) == (number, valid)
            assert body.error_m == pytest.approx(error_m, abs=PRINTED)
            assert (*body.position_m, *body.rotation) == pytest.approx(pose, abs=PRINTED)
        markers = [
            (each.body, each.id, each.occluded, each.point_cloud_solved, each.model_solved)
            for each in frame.labelled_markers
        ]
        assert markers == [each[:5] for each in shown.markers]
        for marker, (*_, size_m, vendors_place) in zip(frame.labelled_markers, shown.markers, strict=True):
            assert (marker.size_m, *marker.position_m) == pytest.approx((size_m, *vendors_place), abs=PRINTED)


def parsed_3_0(packet: bytes) -> Frame:
    return parse_frame(natnet.split(packet)[1], (3, 0))


@pytest.mark.parametrize(
    ("name", "version", "bodies", "markers"),
    [
        ("frame-motive-1.7.2-001", (2, 7), [1], [(0, 1), (0, 2), (0, 3)]),
        ("frame-motive-1.7.2-002", (2, 7), [1], [(0, 1), (0, 2), (0, 3)]),
        ("frame-motive-1.9.0-001", (2, 9), [2], [(2, 1), (2, 2), (2, 3)]),
        ("frame-motive-1.9.0-002", (2, 9), [2], [(2, 1), (2, 2), (2, 3)]),
    ],
)
def test_older_frames_leave_no_byte(
    name: str, version: Version, bodies: list[int], markers: list[tuple[int, int]]
) -> None:
    frame = frame_of(name, version)
    assert frame.bytes_left == 0
    assert [body.id for body in frame.rigid_bodies] == bodies
    assert [(marker.body, marker.id) for marker in frame.labelled_markers] == markers
    assert [marker.position_m for marker in frame.labelled_markers] == list(frame.marker_sets[0].positions_m)
    assert math.hypot(*frame.rigid_bodies[0].rotation) == pytest.approx(1.0, abs=1e-6)


def test_an_occluded_marker_is_said_to_be_occluded() -> None:
    frame = frame_of("mocapframe_packet_occluded_v3", (3, 0))
    assert [(marker.id, marker.occluded) for marker in frame.labelled_markers] == [
        (2, True),
        (3, False),
        (4, False),
        (5, False),
    ]
    assert frame.shares_seen() == {7: 0.75}


@pytest.mark.parametrize(
    ("name", "application", "version", "clock_hz"),
    [
        ("serverinfo_packet_v3", "Motive", (3, 0), CLOCK_HZ),
        ("frame-motive-1.7.2-000", "NatNetLib", (2, 7), 0),
        ("frame-motive-1.9.0-000", "NatNetLib", (2, 9), 0),
    ],
)
def test_what_a_server_says_of_itself(name: str, application: str, version: Version, clock_hz: int) -> None:
    info = natnet.parse_server_info(natnet.split(single(name))[1])
    assert (info.application, info.version, info.clock_hz) == (application, version, clock_hz)


def test_the_names_of_bodies_and_markers() -> None:
    models = parse_models(natnet.split(single("modeldef_packet_v3"))[1], (3, 0))
    assert models.bytes_left == 0
    assert models.name_of(2) == "RaceQuad"
    assert models.name_of(3) == "3"
    assert len(models.bodies[2].markers_m) == 5
    assert models.marker_sets["all"][-1] == "RaceQuad_5"


EXAMPLE = Frame(
    7,
    other_markers_m=((0.5, 0.25, -1.0),),
    rigid_bodies=(
        RigidBody(3, (1.0, 0.5, -2.0), (0.0, 0.0, 0.0, 1.0), 0.5, tracked=True),
        RigidBody(4, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0.0, tracked=False),
    ),
    labelled_markers=(LabelledMarker(1, 3, (1.0, 0.5, -2.0), 0.015625, True, True),),
    timestamp_s=2.5,
    mid_exposure_ticks=100,
    transmit_ticks=200,
    models_changed=True,
)


@pytest.mark.parametrize("version", [(2, 5), (2, 6), (2, 7), (2, 8), (2, 9), (3, 0), (3, 1), (4, 0), (4, 1)])
def test_what_an_emulator_packs_is_read_back(version: Version) -> None:
    frame = parse_frame(pack_frame(EXAMPLE, version), version)
    assert (frame.number, frame.bytes_left, frame.timestamp_s) == (7, 0, 2.5)
    assert frame.rigid_bodies == EXAMPLE.rigid_bodies
    assert frame.other_markers_m == EXAMPLE.other_markers_m
    assert frame.labelled_markers[0].position_m == (1.0, 0.5, -2.0)
    assert (frame.mid_exposure_ticks, frame.transmit_ticks) == ((100, 200) if version >= (3, 0) else (0, 0))
    models = parse_models(
        pack_models([BodyDefinition(3, "r1", markers_m=((1.0, 2.0, 3.0),))], version), version
    )
    assert (models.name_of(3), models.bytes_left) == ("r1", 0)


@pytest.mark.parametrize("version", [(3, 0), (4, 0), (4, 1)])
def test_an_independent_reader_understands_what_an_emulator_packs(version: Version) -> None:
    buffer = PacketBuffer(pack_frame(EXAMPLE, version))
    frame = independent.DataFrame.read_from_buffer(buffer, independent.Version(*version))
    assert [(body.id_num, body.pos, body.rot, body.tracking_valid) for body in frame.rigid_bodies] == [
        (body.id, body.position_m, body.rotation, body.tracked) for body in EXAMPLE.rigid_bodies
    ]
    (marker,) = frame.labeled_markers
    assert (marker.model_id, marker.marker_id, marker.pos, marker.occluded) == (3, 1, (1.0, 0.5, -2.0), True)
    assert frame.suffix.timestamp == EXAMPLE.timestamp_s


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda data: data[:-1], "another length than its header says"),
        (lambda data: data + b"\0", "another length than its header says"),
        (lambda data: data[:2], "cut short"),
    ],
)
def test_a_datagram_that_is_not_whole_is_refused(damage: object, said: str) -> None:
    assert callable(damage)
    with pytest.raises(DatagramError, match=said):
        natnet.split(damage(single("mocapframe_packet_v3")))


def test_a_frame_read_as_another_version_is_refused_or_leaves_bytes() -> None:
    payload = natnet.split(single("mocapframe_packet_v3"))[1]
    for version in [(2, 5), (2, 6), (2, 7), (2, 9), (4, 1)]:
        try:
            frame = parse_frame(payload, version)
        except DatagramError:
            continue
        assert frame.bytes_left


def test_a_count_that_its_bytes_cannot_hold_costs_no_memory() -> None:
    payload = natnet.split(single("mocapframe_packet_v3"))[1]
    with pytest.raises(DatagramError, match="more entries than bytes"):
        parse_frame(payload[:4] + b"\xff\xff\xff\x7f" + payload[8:], (3, 0))


@pytest.mark.parametrize("text", ["2.4", "4.2", "3", "three"])
def test_a_version_that_is_not_known_is_named(text: str) -> None:
    with pytest.raises(ValueError, match="NatNet"):
        natnet.version_of(text)
