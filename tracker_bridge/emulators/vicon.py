"""Vicon Tracker, as far as its UDP object stream shows."""

from __future__ import annotations

import socket
from collections.abc import Iterable

from swarm.config.experiment import Experiment
from tracker_bridge.arena_frame import to_xyz_angles
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.emulators.interface import View
from tracker_bridge.protocols.vicon import UNIT_M, ViconObject, pack

OBJECTS_IN_DATAGRAM = 18
"""1355 bytes: a datagram that is larger than an Ethernet frame is lost with any of its parts."""


class ViconEmulator:
    """Sends every frame to one address. Robots that are not shown are left out."""

    def __init__(self, experiment: Experiment, host: str, port: int) -> None:
        self._view = View(experiment, UNIT_M)
        self._to = (host, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._frame = 0

    def show(self, poses: Iterable[TrackedPose], t_ns: int) -> None:  # noqa: ARG002
        self._frame += 1
        objects = [
            ViconObject(seen.body, seen.position, to_xyz_angles(seen.rotation))
            for seen in self._view.seen(poses)
        ]
        for first in range(0, len(objects), OBJECTS_IN_DATAGRAM):
            self._socket.sendto(pack(self._frame, objects[first : first + OBJECTS_IN_DATAGRAM]), self._to)

    def close(self) -> None:
        self._socket.close()
