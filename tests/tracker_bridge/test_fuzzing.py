"""Random and mutated datagrams: no crash, no wrong pose, every refusal counted by one of few reasons."""

from __future__ import annotations

import math
import random
import select
import socket
import tracemalloc
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

import pytest

from swarm.config.experiment import TrackerSettings
from tests.support.natnet_capture import single
from tests.support.tracked_swarm import LOOPBACK, PLACES, free_udp_port, tracked_experiment
from tracker_bridge.backends.natnet import NatNetTracker
from tracker_bridge.backends.vicon import ViconTracker
from tracker_bridge.emulators.natnet import NatNetEmulator
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings
from tracker_bridge.protocols import natnet, vicon
from tracker_bridge.protocols.natnet import MessageId
from tracker_bridge.protocols.natnet_frame import Frame, RigidBody
from tracker_bridge.protocols.natnet_pack import pack_frame

SHORT, WHOLE = 3_000, 100_000
BATCH = 20
TICK_NS = 10_000_000
FLAT_BYTES = 200_000
"""So much memory may differ between the middle and the end of a fuzzing."""
MOST_REASONS = 40
NATNET_SEEDS = ("mocapframe_packet_occluded_v3", "modeldef_packet_v3", "serverinfo_packet_v3")


def vicon_frame(number: int) -> bytes:
    """The examiners' two robots, which shiver so that they do not look frozen."""
    objects = [
        vicon.ViconObject(
            name, (1000 * pose.x_m + number % 7 * 0.01, 1000 * pose.y_m, 80.0), (0.0, 0.0, pose.theta_rad)
        )
        for name, pose in PLACES.items()
    ]
    return vicon.pack(number, objects)


def natnet_frame(number: int) -> bytes:
    bodies = tuple(
        RigidBody(
            each,
            (pose.x_m + number % 7 * 1e-5, pose.y_m, 0.08),
            (0.0, 0.0, math.sin(pose.theta_rad / 2), math.cos(pose.theta_rad / 2)),
            0.0002,
            tracked=True,
        )
        for each, pose in enumerate(PLACES.values(), 1)
    )
    frame = Frame(number, rigid_bodies=bodies, timestamp_s=number * TICK_NS / 1e9)
    return natnet.packed(MessageId.FRAME, pack_frame(frame, (3, 0)))


def mutated(rng: random.Random, data: bytes) -> bytes:
    """A datagram with some bits flipped, cut, repeated, or with a length or count made large."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8))):
        at = rng.randrange(len(changed) or 1)
        kind = rng.randrange(5)
        if not changed or kind == 0:
            return rng.randbytes(rng.randrange(600))
        if kind == 1:
            changed[at] ^= 1 << rng.randrange(8)
        elif kind == 2:
            del changed[at:]
        elif kind == 3:
            changed[at:at] = changed[: rng.randrange(64)]
        else:
            changed[at : at + 4] = rng.choice((b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\0"))
    return bytes(changed)


def vicon_tracker() -> ViconTracker:
    return ViconTracker(tracked_experiment(TrackerSettings(interface=LOOPBACK, port=free_udp_port())))


def natnet_tracker() -> NatNetTracker:
    """One that has met its server."""
    ports = TrackerSettings(server=LOOPBACK, interface=LOOPBACK, port=free_udp_port())
    experiment = tracked_experiment(replace(ports, command_port=free_udp_port()))
    tracker = NatNetTracker(experiment)
    with closing(NatNetEmulator(experiment, LOOPBACK, (3, 0))) as server:
        while tracker.info is None or not tracker.models.bodies:
            tracker.poses(0)
            server.answer()
    return tracker


def send(tracker: ViconTracker | NatNetTracker, datagrams: list[bytes]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for datagram in datagrams:
            sender.sendto(datagram, (LOOPBACK, tracker.port))
    select.select(tracker.receivers, [], [])


@pytest.mark.parametrize(
    "datagrams", [pytest.param(SHORT, id="some"), pytest.param(WHOLE, id="all", marks=pytest.mark.long)]
)
@pytest.mark.parametrize(
    ("opened", "frame", "seeds"),
    [
        (vicon_tracker, vicon_frame, []),
        (natnet_tracker, natnet_frame, [single(name) for name in NATNET_SEEDS]),
    ],
    ids=["vicon", "natnet"],
)
def test_nothing_that_arrives_hurts(
    opened: Callable[[], ViconTracker | NatNetTracker],
    frame: Callable[[int], bytes],
    seeds: list[bytes],
    datagrams: int,
) -> None:
    """A whole one comes now and then; what the gate believes is where the robots are."""
    rng, plausibility, believed = random.Random(7), Plausibility(PlausibilitySettings(3.0, 2.0)), 0
    middle_bytes = 0
    tracemalloc.start()
    with closing(opened()) as tracker:
        for first in range(0, datagrams, BATCH):
            number = first // BATCH + 1
            whole = frame(number)
            send(tracker, [whole] + [mutated(rng, rng.choice([whole, *seeds])) for _ in range(BATCH)])
            for tracked in tracker.poses(number * TICK_NS):
                pose = tracked.pose
                assert all(map(math.isfinite, (pose.x_m, pose.y_m, pose.theta_rad)))
                if tracked.robot in PLACES and plausibility.reason_against(tracked) is None:
                    believed += 1
                    assert tracked.pose.distance_m(PLACES[tracked.robot]) < 0.15
            if first == datagrams // 2 // BATCH * BATCH:
                middle_bytes = tracemalloc.get_traced_memory()[0]
        assert believed > datagrams // BATCH
        assert sum(tracker.arrivals.refused.values()) > datagrams // 4
        assert len(tracker.arrivals.refused) < MOST_REASONS
        print(dict(tracker.arrivals.refused))
    assert tracemalloc.get_traced_memory()[0] < middle_bytes + FLAT_BYTES
    tracemalloc.stop()
