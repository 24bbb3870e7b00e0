"""A NatNet server: answers clients, and sends frames to a group or to each client."""

from __future__ import annotations

import socket
from collections.abc import Iterable

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment
from tracker_bridge.backends.datagrams import DatagramSocket
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.emulators.interface import SeenRobot, View
from tracker_bridge.protocols import natnet
from tracker_bridge.protocols.cursor import DatagramError, Vector
from tracker_bridge.protocols.natnet import MessageId, ServerInfo, Version
from tracker_bridge.protocols.natnet_frame import Frame, LabelledMarker, RigidBody
from tracker_bridge.protocols.natnet_models import BodyDefinition
from tracker_bridge.protocols.natnet_pack import pack_frame, pack_models

NAME = "swarm emulator"
CLOCK_HZ = 10_000_000
"""The frequency of Windows' performance counter."""
ERROR_M = 0.0002
"""A typical mean error of a body's markers."""
MARKERS: tuple[Vector, ...] = ((0.03, 0.0, 0.0), (-0.02, 0.0, 0.0), (0.0, 0.0, 0.025), (0.01, 0.0, -0.03))
"""Four pins of a hat, in metres from its middle."""
MARKER_M = 0.01


class NatNetEmulator:
    """Serves at a command port; frames go to the group, or to whoever asked lately."""

    def __init__(self, experiment: Experiment, interface: str, version: Version) -> None:
        settings = experiment.tracker
        self._view = View(experiment, 1.0)
        self._numbers = {robot.body or robot.id: each for each, robot in enumerate(experiment.robot, 1)}
        self._group = settings.multicast
        self._data_port = settings.port or natnet.DATA_PORT
        self._version = version
        self._commands = DatagramSocket(interface, settings.command_port or natnet.COMMAND_PORT)
        self._data = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._data.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(interface))
        self._clients: set[tuple[str, int]] = set()
        self._frame = 0
        self._began_ns: int | None = None

    @property
    def port(self) -> int:
        return self._commands.port

    def show(self, poses: Iterable[TrackedPose], t_ns: int) -> None:
        self.answer()
        self._frame += 1
        seen = self._view.seen(poses)
        self._began_ns = t_ns if self._began_ns is None else self._began_ns
        running_ns = t_ns - self._began_ns
        ticks = running_ns * CLOCK_HZ // NS_PER_S
        frame = Frame(
            self._frame,
            rigid_bodies=tuple(self._body(robot) for robot in seen),
            labelled_markers=tuple(marker for robot in seen for marker in self._markers(robot)),
            timestamp_s=running_ns / NS_PER_S,
            mid_exposure_ticks=ticks,
            transmit_ticks=ticks,
        )
        self._send(natnet.packed(MessageId.FRAME, pack_frame(frame, self._version)))

    def answer(self) -> None:
        """Answer whoever has asked something."""
        for datagram in self._commands.arrived():
            host, _, port = datagram.sender.partition(":")
            try:
                number, _ = natnet.split(datagram.data)
            except DatagramError:
                continue
            reply = self._reply(number)
            if number == MessageId.DISCONNECT:
                self._clients.discard((host, int(port)))
            elif not self._group:
                self._clients.add((host, int(port)))
            if reply:
                self._commands.send(reply, host, int(port))

    def close(self) -> None:
        self._commands.close()
        self._data.close()

    def _reply(self, number: int) -> bytes:
        if number == MessageId.CONNECT:
            is_multicast = bool(self._group)
            versions = (1, 0, 0, 0), self._version
            info = ServerInfo(NAME, *versions, CLOCK_HZ, self._data_port, is_multicast, self._group)
            return natnet.packed(MessageId.SERVER_INFO, natnet.pack_server_info(info))
        if number == MessageId.REQUEST_MODEL_DEFINITIONS:
            bodies = [BodyDefinition(each, name, markers_m=MARKERS) for name, each in self._numbers.items()]
            return natnet.packed(MessageId.MODEL_DEFINITIONS, pack_models(bodies, self._version))
        return b""

    def _send(self, packet: bytes) -> None:
        if self._group:
            self._data.sendto(packet, (self._group, self._data_port))
        for client in self._clients:
            self._commands.send(packet, *client)

    def _body(self, robot: SeenRobot) -> RigidBody:
        number = self._numbers.setdefault(robot.body, len(self._numbers) + 1)
        return RigidBody(number, robot.position, robot.rotation, ERROR_M, tracked=True)

    def _markers(self, robot: SeenRobot) -> list[LabelledMarker]:
        body = self._numbers[robot.body]
        return [
            LabelledMarker(each, body, _sum(robot.position, marker), MARKER_M, point_cloud_solved=True)
            for each, marker in enumerate(MARKERS, 1)
        ]


def _sum(one: Vector, other: Vector) -> Vector:
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]
