"""The NatNet backend against the real capture by UDP, and beside an independent client on the same replay."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import natnet as independent
import pytest

from swarm.config.experiment import TrackerSettings
from tests.support.natnet_capture import packets, printed, single
from tests.support.tracked_swarm import LOOPBACK, free_udp_port, tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.natnet import NatNetTracker
from tracker_bridge.protocols.natnet import MULTICAST_GROUP, MessageId
from tracker_bridge.protocols.natnet_frame import Frame

BATCH = 20
"""So few that they fit in any receive buffer."""


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
        tracker.poses(0)
        server.answer(1 if group else 2)
        while tracker.info is None:
            tracker.poses(0)
        tracker.poses(0)
        server.answer(1 if group else 2)
        while not tracker.models.bodies:
            tracker.poses(0)
        yield server, tracker
    finally:
        tracker.close()
        server.close()


def received(tracker: NatNetTracker, count: int, frames: dict[int, Frame] | None = None) -> list[TrackedPose]:
    """So many poses, whenever they arrive; their frames by number go into `frames`."""
    poses: list[TrackedPose] = []
    while len(poses) < count:
        poses += tracker.poses(10**9)
        if frames is not None:
            frames |= {frame.number: frame for frame in tracker.frames}
    return poses


@pytest.mark.parametrize("group", ["", MULTICAST_GROUP], ids=["unicast", "multicast"])
def test_the_whole_capture_arrives_and_agrees_with_the_vendors_client(group: str) -> None:
    frames: dict[int, Frame] = {}
    poses: list[TrackedPose] = []
    with connected(group) as (server, tracker):
        sent = packets(MessageId.FRAME)
        for first in range(0, len(sent), BATCH):
            for packet in sent[first : first + BATCH]:
                server.send(packet, tracker.port)
            poses += received(tracker, len(sent[first : first + BATCH]), frames)
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


def test_a_pose_is_as_old_as_the_server_says() -> None:
    """The vendor's client printed 5.50 ms from exposure to sending for this frame."""
    with connected("") as (server, tracker):
        server.send(packets(MessageId.FRAME)[0], tracker.port)
        (pose,) = received(tracker, 1)
    assert (pose.received_t_ns - pose.captured_t_ns) / 1e6 == pytest.approx(5.50, abs=0.005)
    assert pose.source_t_ns == 1_416_497_730_518 * 10**9 // 3_312_787


def test_a_server_that_sends_to_a_group_says_so() -> None:
    """The captured one does; who listens for its own packets alone would hear nothing."""
    with connected("") as (_, tracker):
        assert tracker.arrivals.hints == {f'the server sends to a group: multicast = "{MULTICAST_GROUP}"'}
    with connected(MULTICAST_GROUP) as (_, tracker):
        assert not tracker.arrivals.hints


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
            received(tracker, len(sent[first : first + BATCH]), ours)
            while len(theirs) < len(ours):
                client.update_sync()
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
