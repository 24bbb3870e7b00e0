"""Vicon Tracker's UDP object stream. It carries no time: a pose is as old as its datagram."""

from __future__ import annotations

from contextlib import closing

from swarm.config.experiment import Experiment
from tracker_bridge.arena_frame import from_xyz_angles
from tracker_bridge.backends.bodies import Body, Roster
from tracker_bridge.backends.clocks import ReceiptClock
from tracker_bridge.backends.datagrams import Arrivals, Datagram, DatagramSocket
from tracker_bridge.backends.interface import TrackedPose, TrackingSystem
from tracker_bridge.protocols.cursor import DatagramError
from tracker_bridge.protocols.vicon import DEFAULT_PORT, UNIT_M, ViconDatagram, ViconObject, parse

REORDERED_FRAMES = 10
"""So late, 0.1 s, a network may deliver a frame; an older one comes from a Tracker started again."""


class ViconTracker:
    """Listens to the stream, which Tracker sends to an address of one's choice or to all of a network."""

    def __init__(self, experiment: Experiment) -> None:
        settings = experiment.tracker
        self.arrivals = Arrivals()
        self._roster = Roster(experiment, UNIT_M)
        self._clock = ReceiptClock()
        self._server = settings.server
        self._socket = DatagramSocket(settings.interface, settings.port or DEFAULT_PORT)
        self.receivers = (self._socket,)
        self._frame: int | None = None
        self._seen: set[str] = set()

    @property
    def port(self) -> int:
        return self._socket.port

    def poses(self, t_ns: int) -> list[TrackedPose]:
        datagrams = list(self._socket.arrived())
        shift_ns = self._clock.shift_ns(t_ns)
        tracked: list[TrackedPose] = []
        for datagram in datagrams:
            received_ns = datagram.received_ns + shift_ns
            bodies = [_body(seen) for seen in self._objects(datagram)]
            tracked += self._roster.tracked(bodies, received_ns, received_ns)
        return tracked

    def close(self) -> None:
        self._socket.close()

    def _objects(self, datagram: Datagram) -> list[ViconObject]:
        self.arrivals.count(datagram.sender)
        try:
            if self._server and datagram.sender.partition(":")[0] != self._server:
                raise DatagramError("from another machine than [tracker] server")
            return self._new(parse(datagram.data))
        except DatagramError as error:
            self.arrivals.refuse(error)
            return []

    def _new(self, part: ViconDatagram) -> list[ViconObject]:
        """The tracked objects of a datagram, unless it is older than the last or repeats it."""
        if self._frame is not None and self._frame - REORDERED_FRAMES < part.frame < self._frame:
            raise DatagramError("of an older frame")
        if part.frame != self._frame:
            self._frame = part.frame
            self._seen.clear()
        named = {seen.name: seen for seen in part.objects}
        new = [seen for name, seen in named.items() if name not in self._seen]
        if part.objects and not new:
            raise DatagramError("sent twice")
        self._seen.update(seen.name for seen in new)
        return [seen for seen in new if seen.tracked]


def _body(seen: ViconObject) -> Body:
    return Body(seen.name, seen.position_mm, from_xyz_angles(seen.rotation_rad))


SYSTEM = TrackingSystem(lambda setup: closing(ViconTracker(setup.experiment)))
