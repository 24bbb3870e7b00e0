"""The `motioncapture` library in its child process: its own system of fixed bodies, and a NatNet server."""

from __future__ import annotations

import math
import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from swarm.clock import NS_PER_S
from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from tests.support.tracked_swarm import LOOPBACK, PLACES, free_udp_port, standing, tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.motioncapture import SILENT_NS, MotionCaptureTracker
from tracker_bridge.emulators.natnet import NatNetEmulator
from tracker_bridge.protocols.natnet import MULTICAST_GROUP, Version

STANDING = "rigid_bodies=" + ";".join(
    f"{robot}({pose.x_m},{pose.y_m},0.08,{math.cos(pose.theta_rad / 2)},0,0,{math.sin(pose.theta_rad / 2)})"
    for robot, pose in PLACES.items()
)
MOCK = TrackerSettings(system="mock", options=(STANDING, "frequency=100"))


@contextmanager
def tracking(settings: TrackerSettings) -> Iterator[MotionCaptureTracker]:
    tracker = MotionCaptureTracker(tracked_experiment(settings))
    try:
        yield tracker
    finally:
        tracker.close()


def first_poses(tracker: MotionCaptureTracker, late_ns: int = 0) -> list[TrackedPose]:
    """What comes first, whenever it comes, by a clock that is so much later than Unix time."""
    while not (poses := tracker.poses(time.time_ns() + late_ns)):
        continue
    return poses


def test_bodies_come_as_the_library_tells_them() -> None:
    with tracking(MOCK) as tracker:
        poses = first_poses(tracker)
    assert {tracked.robot for tracked in poses} == {"a", "b"}
    for tracked in poses:
        assert tracked.pose.distance_m(PLACES[tracked.robot]) < 1e-6
        assert tracked.pose.theta_rad == pytest.approx(PLACES[tracked.robot].theta_rad, abs=1e-6)
        assert tracked.captured_t_ns == tracked.received_t_ns <= time.time_ns()


@pytest.mark.parametrize("version", [(3, 0), (4, 1)])
def test_it_reads_what_our_natnet_server_sends(version: Version) -> None:
    """An independent reader of both layouts: 4.1 has sizes in it, and there is no capture of it here."""
    settings = TrackerSettings(
        system="optitrack",
        server=LOOPBACK,
        interface=LOOPBACK,
        command_port=free_udp_port(),
        port=free_udp_port(),
        multicast=MULTICAST_GROUP,
        options=(f"interface_ip={LOOPBACK}",),
    )
    server = NatNetEmulator(tracked_experiment(settings), LOOPBACK, version)
    with tracking(settings) as tracker:
        poses: list[TrackedPose] = []
        while not poses:
            server.show(standing(NS_PER_S), NS_PER_S)
            poses = tracker.poses(NS_PER_S)
    server.close()
    for tracked in poses:
        assert tracked.pose.distance_m(PLACES[tracked.robot]) < 1e-6


def test_a_child_that_was_killed_is_replaced() -> None:
    with tracking(MOCK) as tracker:
        first_poses(tracker)
        killed = tracker.child
        os.kill(killed, signal.SIGKILL)
        os.waitid(os.P_PID, killed, os.WEXITED | os.WNOWAIT)
        while tracker.poses(time.time_ns()):
            continue
        tracker.poses(time.time_ns() + SILENT_NS)
        assert tracker.child != killed
        assert first_poses(tracker, late_ns=SILENT_NS)
        assert tracker.arrivals.refused == {"no frame for 5 s: connecting again": 1}


def test_a_server_that_is_not_there_delays_nobody() -> None:
    """Vicon's client then connects for ever; the bridge goes on, and takes the child with it."""
    with tracking(TrackerSettings(system="vicon", server="127.0.0.1")) as tracker:
        assert tracker.poses(NS_PER_S) == []
        child = tracker.child
    with pytest.raises(ProcessLookupError):
        os.kill(child, 0)


def test_a_system_that_the_library_does_not_know_is_named() -> None:
    with pytest.raises(UserError, match="one of qualisys, vrpn, vicon, optitrack, mock is needed"):
        MotionCaptureTracker(tracked_experiment(TrackerSettings(system="nokov")))
