"""OptiTrack by NatNet: asks the server for its version and names, then takes its frames as they come.

The client of PyPI's `natnet` waits in its constructor, reads no frame before 3.0 and trusts counts: here it
is the yardstick of the tests instead.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, TrackerSettings
from swarm.errors import UserError
from tracker_bridge.backends.bodies import Body, Roster
from tracker_bridge.backends.clocks import ReceiptClock, SourceClock
from tracker_bridge.backends.datagrams import Arrivals, Datagram, DatagramSocket
from tracker_bridge.backends.interface import TrackedPose, TrackingSystem
from tracker_bridge.protocols import natnet
from tracker_bridge.protocols.cursor import DatagramError
from tracker_bridge.protocols.natnet import MessageId, ServerInfo
from tracker_bridge.protocols.natnet_frame import LONGEST_S, Frame, RigidBody, parse_frame
from tracker_bridge.protocols.natnet_models import Models, parse_models

ASK_EVERY_NS = NS_PER_S
"""Servers forget a unicast client that is silent for some seconds."""
UNIT_M = 1.0
"""Motive streams metres, whatever it shows."""


class NatNetTracker:
    """A client of one server, unicast or multicast."""

    def __init__(self, experiment: Experiment) -> None:
        settings = experiment.tracker
        self.arrivals = Arrivals()
        self.info: ServerInfo | None = _given_info(settings)
        self.frames: list[Frame] = []
        """The frames of the last call of `poses`."""
        self.models = Models({}, {})
        """The names of the bodies, as far as they are known."""
        self._settings = settings
        self._roster = Roster(experiment, UNIT_M)
        self._knows_models = False
        self._doubts_version = False
        self._receipts = ReceiptClock()
        self._clock = SourceClock()
        self._asked_ns: int | None = None
        self._commands = DatagramSocket(settings.interface, 0)
        self._data = DatagramSocket(settings.interface, settings.port or natnet.DATA_PORT, settings.multicast)
        self.receivers = (self._commands, self._data)
        """A server sends to the one that asked, or to the port for data."""

    @property
    def port(self) -> int:
        return self._data.port

    def poses(self, t_ns: int) -> list[TrackedPose]:
        self._ask(t_ns)
        self.frames = []
        arrived = [(each, datagram) for each in self.receivers for datagram in each.arrived()]
        shift_ns = self._receipts.shift_ns(t_ns)
        tracked: list[TrackedPose] = []
        for receiver, datagram in arrived:
            frame = self._frame(datagram, receiver is self._commands)
            if frame:
                self.frames.append(frame)
                tracked += self._tracked(frame, datagram.received_ns + shift_ns)
        return tracked

    def close(self) -> None:
        if self._settings.server:
            self._send(natnet.packed(MessageId.DISCONNECT))
        for receiver in self.receivers:
            receiver.close()

    def _ask(self, t_ns: int) -> None:
        """Once a second: what is not known, or not sure any more; and that this client still listens."""
        if not self._settings.server or (self._asked_ns is not None and t_ns - self._asked_ns < ASK_EVERY_NS):
            return
        self._asked_ns = t_ns
        if self.info is None or self._doubts_version:
            self._doubts_version = False
            self._send(natnet.connect("tracker-bridge"))
        elif not self._knows_models:
            self._send(natnet.packed(MessageId.REQUEST_MODEL_DEFINITIONS))
        if not self._settings.multicast:
            self._send(natnet.packed(MessageId.KEEP_ALIVE))

    def _send(self, packet: bytes) -> None:
        port = self._settings.command_port or natnet.COMMAND_PORT
        self._commands.send(packet, self._settings.server, port)

    def _frame(self, datagram: Datagram, is_answer: bool) -> Frame | None:
        """Take in a packet, which may be an answer only if it came to where questions are sent from."""
        self.arrivals.count(datagram.sender)
        try:
            if self._settings.server and datagram.sender.partition(":")[0] != self._settings.server:
                raise DatagramError("from another machine than [tracker] server")
            return self._understood(*natnet.split(datagram.data), is_answer)
        except DatagramError as error:
            self._doubts_version = True
            self.arrivals.refuse(error)
            return None

    def _understood(self, number: int, payload: bytes, is_answer: bool) -> Frame | None:
        if number != MessageId.FRAME and not is_answer:
            raise DatagramError("an answer that nobody asked for")
        if number == MessageId.SERVER_INFO:
            self._meet(natnet.parse_server_info(payload))
        elif number in (MessageId.FRAME, MessageId.MODEL_DEFINITIONS) and self.info is None:
            raise DatagramError("of a version not known yet: set [tracker] server, or version")
        elif number == MessageId.MODEL_DEFINITIONS and self.info:
            self.models, self._knows_models = parse_models(payload, self.info.version), True
        elif number == MessageId.FRAME and self.info:
            return self._checked(parse_frame(payload, self.info.version))
        return None

    def _meet(self, info: ServerInfo) -> None:
        if not natnet.is_known(info.version):
            raise DatagramError("of a NatNet version that is not known; 2.5 to 4.1 are")
        self.info = info
        self._asked_ns = None
        if info.is_multicast and info.group != self._settings.multicast:
            self.arrivals.hints.add(f'the server sends to a group: multicast = "{info.group}"')

    def _checked(self, frame: Frame) -> Frame:
        if frame.bytes_left:
            raise DatagramError("a frame with bytes left over: is it of another version?")
        numbers = [body.id for body in frame.rigid_bodies]
        if len(set(numbers)) < len(numbers):
            raise DatagramError("a frame with a body twice")
        under_way = frame.transmit_ticks - frame.mid_exposure_ticks
        if under_way < 0 or self._seconds(frame.transmit_ticks) > LONGEST_S:
            raise DatagramError("a time that cannot be")
        if frame.models_changed:
            self._knows_models = False
        return frame

    def _tracked(self, frame: Frame, received_ns: int) -> Iterator[TrackedPose]:
        source_ns, sent_ns = self._times_ns(frame)
        captured_ns = self._clock.captured_ns(source_ns, sent_ns, received_ns)
        shares = frame.shares_seen()
        bodies = [self._body(body, shares) for body in frame.rigid_bodies if body.tracked]
        return self._roster.tracked(bodies, captured_ns, received_ns, source_ns)

    def _seconds(self, ticks: int) -> float:
        return ticks / self.info.clock_hz if self.info and self.info.clock_hz else 0.0

    def _times_ns(self, frame: Frame) -> tuple[int, int]:
        """When the cameras exposed and when the frame was sent, by the server's clock."""
        if self.info and self.info.clock_hz and frame.mid_exposure_ticks:
            exposed = frame.mid_exposure_ticks * NS_PER_S // self.info.clock_hz
            under_way = frame.transmit_ticks - frame.mid_exposure_ticks
            return exposed, exposed + under_way * NS_PER_S // self.info.clock_hz
        return (round(frame.timestamp_s * NS_PER_S),) * 2

    def _body(self, body: RigidBody, shares: dict[int, float]) -> Body:
        name = self.models.name_of(body.id)
        return Body(name, body.position_m, body.rotation, body.error_m, shares.get(body.id, 0.0))


def _given_info(settings: TrackerSettings) -> ServerInfo | None:
    """What the experiment says of a server that does not answer."""
    if not settings.version:
        return None
    try:
        return ServerInfo("", (), natnet.version_of(settings.version))
    except ValueError as error:
        raise UserError(f"[tracker] version: {error}") from error


SYSTEM = TrackingSystem(lambda setup: closing(NatNetTracker(setup.experiment)))
