"""The Vicon backend against datagrams as they come: split, filled up, with lost and unknown items."""

from __future__ import annotations

import math
import select
import socket
import struct
from collections.abc import Iterator

import pytest

from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose
from tests.support.tracked_swarm import LOOPBACK, free_udp_port, tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.vicon import ViconTracker
from tracker_bridge.emulators.vicon import OBJECTS_IN_DATAGRAM, ViconEmulator
from tracker_bridge.protocols.vicon import ViconObject, pack, parse

FIFTY = [f"r{number}" for number in range(50)]
PERIOD_NS = 10_000_000
"""100 Hz."""
BUFFER_BYTES = 512
"""What some senders fill a datagram up to."""


class Stream:
    """A backend, and what sends to it."""

    def __init__(self, robots: list[str]) -> None:
        settings = TrackerSettings(interface=LOOPBACK, port=free_udp_port())
        self.experiment = tracked_experiment(settings, robots)
        self.tracker = ViconTracker(self.experiment)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(self, *datagrams: bytes) -> None:
        for datagram in datagrams:
            self._socket.sendto(datagram, (LOOPBACK, self.tracker.port))
        select.select(self.tracker.receivers, [], [])

    def close(self) -> None:
        self.tracker.close()
        self._socket.close()


@pytest.fixture
def stream() -> Iterator[Stream]:
    stream = Stream(["a", "b"])
    yield stream
    stream.close()


def seen(name: str, x_mm: float, y_mm: float = 500.0, turn_rad: float = 0.0) -> ViconObject:
    return ViconObject(name, (x_mm, y_mm, 80.0), (0.0, 0.0, turn_rad))


def found(tracker: ViconTracker, t_ns: int = PERIOD_NS) -> list[tuple[str, float]]:
    return [(tracked.robot, tracked.pose.x_m) for tracked in tracker.poses(t_ns)]


def test_the_bytes_are_those_of_the_user_guide() -> None:
    """Written out by hand: 75 bytes an object, little-endian."""
    item = struct.pack("<BH24s6d", 0, 72, b"r1", 1.0, 2.0, 3.0, 0.1, 0.2, 0.3)
    data = struct.pack("<IB", 9, 1) + item
    assert len(data) == 5 + 75
    part = parse(data)
    assert (part.frame, part.objects) == (9, (ViconObject("r1", (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)),))
    assert pack(9, part.objects) == data


def test_fifty_objects_at_100_hz_arrive_without_a_loss() -> None:
    stream = Stream(FIFTY)
    emulator = ViconEmulator(stream.experiment, LOOPBACK, stream.tracker.port)
    count = 0
    for frame in range(1, 301):
        t_ns = frame * PERIOD_NS
        swarm = [TrackedPose(robot, Pose(0.1 + 0.001 * frame, 1.0, 0.5), t_ns) for robot in FIFTY]
        emulator.show(swarm, t_ns)
        select.select(stream.tracker.receivers, [], [])
        tracked = stream.tracker.poses(t_ns)
        assert [each.robot for each in tracked] == FIFTY
        assert all(each.pose.distance_m(swarm[0].pose) < 1e-9 for each in tracked)
        assert all(
            abs(each.pose.theta_rad - 0.5) < 1e-9 and abs(each.tilt_rad or 0.0) < 1e-6 for each in tracked
        )
        count += len(tracked)
    assert count == 15_000
    assert sum(stream.tracker.arrivals.senders.values()) == 300 * math.ceil(50 / OBJECTS_IN_DATAGRAM)
    assert not stream.tracker.arrivals.refused
    emulator.close()
    stream.close()


def test_a_frame_may_come_in_parts(stream: Stream) -> None:
    stream.send(pack(5, [seen("a", 100.0)]), pack(5, [seen("b", 200.0)]), pack(6, [seen("b", 201.0)]))
    assert found(stream.tracker) == [("a", 0.1), ("b", 0.2), ("b", 0.201)]


def test_what_fills_a_datagram_up_is_left(stream: Stream) -> None:
    stream.send(pack(5, [seen("a", 100.0)]).ljust(BUFFER_BYTES, b"\0"))
    stream.send(pack(6, [seen("a", 101.0)]).ljust(BUFFER_BYTES, b"\xff"))
    assert found(stream.tracker) == [("a", 0.1), ("a", 0.101)]


def test_an_item_of_an_unknown_kind_is_passed_over(stream: Stream) -> None:
    objects = pack(5, [seen("a", 100.0), seen("b", 200.0)])
    unknown = struct.pack("<BH", 3, 11) + b"?" * 11
    stream.send(objects[:4] + b"\x03" + objects[5:80] + unknown + objects[80:])
    assert found(stream.tracker) == [("a", 0.1), ("b", 0.2)]


def test_an_object_that_is_lost_has_no_pose_and_delays_nobody(stream: Stream) -> None:
    lost = ViconObject("a", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    stream.send(pack(5, [lost, seen("b", 200.0)]), pack(6, [seen("b", 201.0)]))
    assert found(stream.tracker) == [("b", 0.2), ("b", 0.201)]
    assert not stream.tracker.arrivals.refused


def test_a_frame_that_comes_again_or_too_late_is_refused(stream: Stream) -> None:
    stream.send(pack(5, [seen("a", 100.0)]), pack(5, [seen("a", 100.0)]), pack(4, [seen("a", 99.0)]))
    assert found(stream.tracker) == [("a", 0.1)]
    assert stream.tracker.arrivals.refused == {"sent twice": 1, "of an older frame": 1}


def test_an_object_that_is_in_a_datagram_twice_is_seen_once(stream: Stream) -> None:
    stream.send(pack(5, [seen("a", 100.0), seen("b", 200.0), seen("a", 101.0)]))
    assert found(stream.tracker) == [("a", 0.101), ("b", 0.2)]


def test_a_tracker_that_was_started_again_is_followed(stream: Stream) -> None:
    stream.send(pack(500_000, [seen("a", 100.0)]), pack(1, [seen("a", 101.0)]))
    assert found(stream.tracker) == [("a", 0.1), ("a", 0.101)]


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "cut short"),
        (pack(5, [seen("a", 1.0)])[:-1], "cut short"),
        (pack(5, [seen("a", math.nan)]), "not a number"),
        (struct.pack("<IBBH", 5, 1, 0, 8) + b"\0" * 8, "an object of another size"),
        (pack(5, [seen("a", 1.0)]).replace(b"a\0", b"\xff\0", 1), "a name that is no text"),
    ],
)
def test_what_is_no_object_stream_is_refused_and_counted(stream: Stream, data: bytes, reason: str) -> None:
    stream.send(data, pack(6, [seen("b", 200.0)]))
    assert found(stream.tracker) == [("b", 0.2)]
    assert stream.tracker.arrivals.refused == {reason: 1}


def test_receipt_is_when_the_kernel_had_it(stream: Stream) -> None:
    """Two datagrams that wait together were received one after the other, before they were read."""
    stream.send(pack(5, [seen("a", 100.0)]), pack(6, [seen("a", 101.0)]))
    first, second = stream.tracker.poses(10**9)
    assert first.received_t_ns < second.received_t_ns < 10**9
