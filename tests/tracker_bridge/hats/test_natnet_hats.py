"""Robots named by their hats from NatNet's own bytes, over a socket."""

from __future__ import annotations

import math
import select
import socket
import time
from contextlib import closing

import pytest

from swarm.clock import NS_PER_S
from swarm.config.experiment import TrackerSettings
from swarm.geometry import Pose
from tests.support.tracked_swarm import LOOPBACK, PLACES, free_udp_port, tracked_experiment
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.backends.natnet_hats import NatNetHats
from tracker_bridge.hats.design import design_hats
from tracker_bridge.hats.patterns import Hat, PinGrid
from tracker_bridge.protocols import natnet
from tracker_bridge.protocols.natnet import MessageId
from tracker_bridge.protocols.natnet_frame import Frame
from tracker_bridge.protocols.natnet_pack import pack_frame

VERSION = (3, 0)


def frame_of(t_ns: int, hats: list[Hat], places: dict[str, Pose]) -> bytes:
    """A frame of markers without labels; Motive's y is up, and its z points to the south."""
    markers = []
    for hat in hats:
        for pin in hat.pins:
            place = places[hat.name].compose(Pose(pin.real, pin.imag, 0.0))
            markers.append((place.x_m, 0.12, -place.y_m))
    frame = Frame(1, other_markers_m=tuple(markers), timestamp_s=t_ns / NS_PER_S)
    return natnet.packed(MessageId.FRAME, pack_frame(frame, VERSION))


def followed(backend: NatNetHats, clouds: int, places: dict[str, Pose], hats: list[Hat]) -> list[TrackedPose]:
    """What the last of some clouds shows."""
    poses: list[TrackedPose] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        for _ in range(clouds):
            server.sendto(frame_of(time.monotonic_ns(), hats, places), (LOOPBACK, backend.port))
            select.select(backend.receivers, [], [])
            poses = backend.poses(time.monotonic_ns())
    return poses


def test_robots_are_named_and_a_swap_is_told() -> None:
    hats = [Hat(name, hat.pins) for name, hat in zip(PLACES, design_hats(PinGrid(), 20), strict=False)]
    settings = TrackerSettings(interface=LOOPBACK, port=free_udp_port(), version="3.0", axes="x -z y")
    with closing(NatNetHats(tracked_experiment(settings), hats)) as backend:
        poses = {tracked.robot: tracked for tracked in followed(backend, 10, PLACES, hats)}
        assert set(poses) == set(PLACES)
        for robot, place in PLACES.items():
            assert poses[robot].pose.distance_m(place) < 1e-4
            assert math.cos(poses[robot].pose.theta_rad - place.theta_rad) == pytest.approx(1.0, abs=1e-4)
            assert poses[robot].quality == 1.0
        exchanged = {"a": PLACES["b"], "b": PLACES["a"]}
        poses = {tracked.robot: tracked for tracked in followed(backend, 60, exchanged, hats)}
        assert poses["a"].pose.distance_m(PLACES["b"]) < 1e-4
        assert [text for name, text in backend.told() if name == "swap"] == [
            "hats a and b have swapped places"
        ]
        assert backend.told() == []
