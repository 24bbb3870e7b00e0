"""Every tracker backend passes the backend's contract."""

from __future__ import annotations

import math
import select
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from swarm.config.experiment import ArenaSettings, TrackerSettings
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.runtime.subscription import Received
from tests.contracts.examiners import BACKEND_CHECKS, SECOND_NS, BackendRig
from tests.support.tracked_swarm import LOOPBACK, free_udp_port, standing, tracked_experiment
from tracker_bridge.backends.natnet import NatNetTracker
from tracker_bridge.backends.overhead import Camera, OverheadTracker
from tracker_bridge.backends.overhead_sim import FAMILY, RenderedTruth, camera_over
from tracker_bridge.backends.sim import SimulatedTracker
from tracker_bridge.backends.vicon import ViconTracker
from tracker_bridge.emulators.camera.true_view import true_view
from tracker_bridge.emulators.interface import Emulator
from tracker_bridge.emulators.natnet import NatNetEmulator
from tracker_bridge.emulators.vicon import ViconEmulator
from tracker_bridge.overhead.settings import RobotTag
from tracker_bridge.overhead.tag_tracking import TagTracker
from tracker_bridge.overhead.tags import TagDetector, TagFamily
from tracker_bridge.protocols.natnet import MULTICAST_GROUP, Version

TRUTHS = {
    "a": pb.Truth(x_m=1.0, y_m=0.5, theta_rad=math.pi / 2),
    "b": pb.Truth(x_m=2.0, y_m=1.5, theta_rad=math.pi),
}


class TruthTeller:
    """Robots that stand and tell the truth of each moment once."""

    def __init__(self) -> None:
        self._told: list[Received[pb.Truth]] = []
        self._sequence = 0

    def run_to(self, t_ns: int) -> None:
        self._sequence += 1
        header = Header(1, self._sequence, t_ns)
        self._told.extend(Received(robot, header, truth) for robot, truth in TRUTHS.items())

    def close(self) -> None:
        """There is nothing to close."""

    def take(self) -> list[Received[pb.Truth]]:
        told, self._told = self._told, []
        return told


class SimulatedRig(TruthTeller):
    """The simulated tracker, to which robots that stand tell the truth."""

    tolerance_m = 0.01
    tolerance_rad = 0.06

    def __init__(self) -> None:
        super().__init__()
        self.backend = SimulatedTracker(TrackerSettings(), self.take, lambda _: np.random.default_rng(1))


class EmulatedRig:
    """A tracking system's emulator, and the backend that listens to it."""

    tolerance_m = 1e-6
    tolerance_rad = 1e-6

    def __init__(self, backend: NatNetTracker | ViconTracker, emulator: Emulator) -> None:
        self.backend = backend
        self._emulator = emulator

    def run_to(self, t_ns: int) -> None:
        self._emulator.show(standing(t_ns), t_ns)
        select.select(self.backend.receivers, [], [])

    def close(self) -> None:
        self._emulator.close()
        self.backend.close()


class CameraRig(TruthTeller):
    """A camera above robots that stand, and the tracker that looks at its pictures."""

    tolerance_m = 0.003
    tolerance_rad = math.radians(1)

    def __init__(self) -> None:
        super().__init__()
        camera = camera_over(ArenaSettings(height_m=2.0), len(TRUTHS), np.random.default_rng(1))
        source = RenderedTruth(camera, list(TRUTHS), 10.0, self.take)
        tags = {number: RobotTag(number, robot) for number, robot in enumerate(TRUTHS)}
        tracker = TagTracker(TagDetector(TagFamily(FAMILY, tags)))
        seen = Camera(source, true_view(camera), tracker)
        self.backend = OverheadTracker([seen], tags, camera.plate.side_m, camera.plate.height_m)


TURNED = TrackerSettings(interface=LOOPBACK, axes="x -z y", origin_m=(1.2, -0.4), turn_rad=0.7)
"""A system whose y is up and whose origin and axes are not the arena's."""


def vicon() -> EmulatedRig:
    experiment = tracked_experiment(replace(TURNED, port=free_udp_port()))
    backend = ViconTracker(experiment)
    return EmulatedRig(backend, ViconEmulator(experiment, LOOPBACK, backend.port))


def natnet(version: Version = (3, 0), group: str = "") -> EmulatedRig:
    """A server and a client that have met."""
    settings = replace(TURNED, server=LOOPBACK, port=free_udp_port(), multicast=group)
    experiment = tracked_experiment(replace(settings, command_port=free_udp_port()))
    backend, emulator = NatNetTracker(experiment), NatNetEmulator(experiment, LOOPBACK, version)
    while backend.info is None or not backend.models.bodies:
        backend.poses(0)
        emulator.answer()
    return EmulatedRig(backend, emulator)


RIGS: dict[str, Callable[[], BackendRig]] = {
    "simulated": SimulatedRig,
    "vicon": vicon,
    "natnet 2.5": partial(natnet, (2, 5)),
    "natnet 2.9": partial(natnet, (2, 9)),
    "natnet 3.0": natnet,
    "natnet 4.1": partial(natnet, (4, 1)),
    "natnet multicast": partial(natnet, (3, 0), MULTICAST_GROUP),
    "overhead camera": CameraRig,
}


@pytest.mark.parametrize("check", BACKEND_CHECKS, ids=lambda check: check.__name__.lstrip("_"))
@pytest.mark.parametrize("name", RIGS)
def test_backend_contract(name: str, check: Callable[[BackendRig, int], None]) -> None:
    rig = RIGS[name]()
    try:
        check(rig, SECOND_NS)
    finally:
        rig.close()
