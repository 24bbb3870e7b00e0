"""The NatNet backend against the real capture by UDP, and beside an independent client on the same replay."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise

import natnet as independent
import pytest

from swarm.config.experiment import TrackerSettings
from tests.support.natnet_capture import packets, printed, single
from tests.support.tracked_swarm import LOOPBACK, free_udp_port, tracked_experiment
from tracker_bridge.backends.natnet import NatNetTracker
from tracker_bridge.protocols.natnet import MULTICAST_GROUP, MessageId
from tracker_bridge.protocols.natnet_frame import Frame

BATCH = 20
"""So few that they fit in any receive buffer."""
TICK_NS = 2_000_000


class ReplayServer:
    """The captured server: its own bytes, at ports of this test."""

    def __init__(self, group: str = "") -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((LOOPBACK, 0))
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(LOOPBACK))
        self.port: int = self._socket.getsockname()[1]
        self.group = group
        self.clients: set[tuple[str, int]] = set()

    def answer(self, questions: int) -> None:
        """Wait for so many packets of clients and answer each as the captured server did."""
        for _ in range(questions):
            data, client = self._socket.recvfrom(2048)
            self.clients.add(client)
            number = struct.unpack_from("<H", data)[0]
            if number == MessageId.CONNECT:
                self._socket.sendto(single("serverinfo_packet_v3"), client)
            elif number == MessageId.REQUEST_MODEL_DEFINITIONS:
                self._socket.sendto(single("modeldef_packet_v3"), client)

    def send(self, packet: bytes, data_port: int) -> None:
        for target in [(self.group, data_port)] if self.group else self.clients:
            self._socket.sendto(packet, target)

    def close(self) -> None:
        self._socket.close()


@contextmanager
def connected(group: str) -> Iterator[tuple[ReplayServer, NatNetTracker]]:
    """The server, and a tracker that knows the server's version and the bodies' names."""
    server = ReplayServer(group)
    settings = TrackerSettings(
        server=LOOPBACK,
        interface=LOOPBACK,
        command_port=server.port,
        port=free_udp_port(),
        multicast=group,
        axes="x -z y",
    )
    tracker = NatNetTracker(tracked_experiment(settings, ["quad"], ["RaceQuad"]))
    try:
        for _ in ("version", "names"):
            tracker.poses(0)
            server.answer(1 if group else 2)
            assert tracker.poses(0) == []
        assert tracker.info
        yield server, tracker
    finally:
        tracker.close()
        server.close()


@pytest.mark.parametrize("group", ["", MULTICAST_GROUP], ids=["unicast", "multicast"])
def test_the_whole_capture_arrives_and_agrees_with_the_vendors_client(group: str) -> None:
    frames: dict[int, Frame] = {}
    poses = []
    with connected(group) as (server, tracker):
        sent = packets(MessageId.FRAME)
        for first in range(0, len(sent), BATCH):
            for packet in sent[first : first + BATCH]:
                server.send(packet, tracker.port)
            poses += tracker.poses((3 + first) * TICK_NS)
            frames |= {frame.number: frame for frame in tracker.frames}
        assert not tracker.arrivals.refused
    assert len(frames) == len(poses) == 518
    for shown in printed():
        (body,) = frames[shown.number].rigid_bodies
        assert (*body.position_m, *body.rotation) == pytest.approx(shown.bodies[0][3], abs=0.005 + 1e-6)
    assert {pose.robot for pose in poses} == {"quad"}
    assert all(pose.quality == 1.0 and 0 < pose.residual_m < 0.001 for pose in poses)
    assert poses[0].pose.x_m == pytest.approx(0.17444664)
    assert poses[0].pose.y_m == pytest.approx(0.73430401)
    assert poses[0].height_m == pytest.approx(1.44713140)


def test_times_of_capture_have_the_cameras_pace() -> None:
    """Cameras expose every 8.33 ms and a frame is 5.5 ms old when sent, though each seventh is 3 ms late."""
    poses = []
    with connected("") as (server, tracker):
        for number, packet in enumerate(packets(MessageId.FRAME)):
            server.send(packet, tracker.port)
            late_ns = 3_000_000 * (number % 7 == 3)
            poses += tracker.poses(10**9 + number * 8_333_333 + late_ns)
    assert len(poses) == 518
    settled = [pose.captured_t_ns for pose in poses[20:]]
    gaps_ms = [(later - earlier) / 1e6 for earlier, later in pairwise(settled)]
    assert gaps_ms == pytest.approx([8.333] * len(gaps_ms), abs=1.0)
    ages_ms = sorted((pose.received_t_ns - pose.captured_t_ns) / 1e6 for pose in poses[20:])
    assert ages_ms[len(ages_ms) // 2] == pytest.approx(5.5, abs=1.0)


def test_an_independent_client_sees_the_same() -> None:
    theirs: dict[int, independent.DataFrame] = {}
    ours: dict[int, Frame] = {}
    with connected(MULTICAST_GROUP) as (server, tracker):
        client = independent.NatNetClient(
            LOOPBACK, LOOPBACK, MULTICAST_GROUP, server.port, tracker.port, use_multicast=True
        )
        client.on_data_frame_received_event.handlers.append(
            lambda frame: theirs.__setitem__(frame.prefix.frame_number, frame)
        )
        answering = threading.Thread(target=server.answer, args=(1,))
        answering.start()
        client.connect()
        answering.join()
        sent = packets(MessageId.FRAME)
        for first in range(0, len(sent), BATCH):
            for packet in sent[first : first + BATCH]:
                server.send(packet, tracker.port)
            client.update_sync()
            tracker.poses((3 + first) * TICK_NS)
            ours |= {frame.number: frame for frame in tracker.frames}
        client.shutdown()
    assert len(theirs) == 518
    assert theirs.keys() == ours.keys()
    for number, frame in ours.items():
        other = theirs[number]
        assert [
            (body.id, body.position_m, body.rotation, body.error_m, body.tracked)
            for body in frame.rigid_bodies
        ] == [
            (body.id_num, body.pos, body.rot, body.marker_error, body.tracking_valid)
            for body in other.rigid_bodies
        ]
        assert frame.other_markers_m == other.unlabeled_marker_pos
        assert [
            (each.id, each.body, each.position_m, each.size_m, each.residual_m)
            for each in frame.labelled_markers
        ] == [
            (each.marker_id, each.model_id, each.pos, each.size, each.residual)
            for each in other.labeled_markers
        ]
        assert frame.timestamp_s == other.suffix.timestamp
        assert frame.mid_exposure_ticks == other.suffix.stamp_camera_mid_exposure
