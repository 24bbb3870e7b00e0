"""Qualisys, VRPN, Vicon DataStream and others, by the library `motioncapture` in a process of its own.

The library waits without a limit, for a server that is not there for ever, and says neither time nor
residuals. So a child process waits, and tells of each frame by a line; if it falls silent it is replaced.
`python -m tracker_bridge.backends.motioncapture` is that child.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from typing import Any

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment, TrackerSettings
from swarm.errors import UserError
from swarm.extras import require_extra
from swarm.interpreter import child_environment, module_command
from tracker_bridge.backends.bodies import Body, Roster
from tracker_bridge.backends.clocks import ReceiptClock
from tracker_bridge.backends.datagrams import Arrivals
from tracker_bridge.backends.interface import TrackedPose, TrackingSystem
from tracker_bridge.protocols.cursor import DatagramError, finite

UNIT_M = 1.0
"""The library gives metres."""
SYSTEMS = ("qualisys", "vrpn", "vicon", "optitrack", "mock")
"""Those that the library's wheels can talk to."""
SILENT_NS = 5 * NS_PER_S
"""Connecting takes up to 2 s; a system that streams is never silent so long."""
PR_SET_PDEATHSIG = 1
"""Linux: what the kernel sends to a child whose parent has died (prctl(2))."""


class MotionCaptureTracker:
    """Reads what the child tells, and replaces a child that fell silent."""

    def __init__(self, experiment: Experiment) -> None:
        settings = experiment.tracker
        if settings.system not in SYSTEMS:
            raise UserError(f"[tracker] system is {settings.system!r}; one of {', '.join(SYSTEMS)} is needed")
        require_extra("mocap", "motioncapture")
        self.arrivals = Arrivals()
        self._roster = Roster(experiment, UNIT_M)
        self._sender = f"{settings.system} {settings.server}".strip()
        self._command = module_command(__name__, settings.system, json.dumps(_options(settings)))
        self._receipts = ReceiptClock()
        self._heard_ns: int | None = None
        self._start()

    @property
    def child(self) -> int:
        """The number of the child process."""
        return self._child.pid

    def poses(self, t_ns: int) -> list[TrackedPose]:
        self._heard_ns = t_ns if self._heard_ns is None else self._heard_ns
        tracked: list[TrackedPose] = []
        lines = self._lines()
        shift_ns = self._receipts.shift_ns(t_ns)
        for line in lines:
            self._heard_ns = t_ns
            tracked += self._tracked(line, shift_ns)
        if t_ns - self._heard_ns > SILENT_NS:
            self.arrivals.refuse(DatagramError(f"no frame for {SILENT_NS // NS_PER_S} s: connecting again"))
            self._stop()
            self._start()
            self._heard_ns = t_ns
        return tracked

    def close(self) -> None:
        self._stop()

    def _start(self) -> None:
        self._unfinished = b""
        self._told, telling = os.pipe()
        os.set_blocking(self._told, False)
        command = [*self._command, str(telling)]
        self._child = subprocess.Popen(
            command, env=child_environment(), pass_fds=[telling], stdout=subprocess.DEVNULL
        )
        os.close(telling)

    def _stop(self) -> None:
        self._child.kill()
        self._child.wait()
        os.close(self._told)

    def _lines(self) -> list[bytes]:
        """Whole lines that have come since the last call."""
        try:
            while block := os.read(self._told, 65_536):
                self._unfinished += block
        except BlockingIOError:
            pass
        *lines, self._unfinished = self._unfinished.split(b"\n")
        return lines

    def _tracked(self, line: bytes, shift_ns: int) -> Iterator[TrackedPose]:
        self.arrivals.count(self._sender)
        seen_ns, bodies = json.loads(line)
        received_ns = seen_ns + shift_ns
        return self._roster.tracked([_body(*each) for each in bodies], received_ns, received_ns)


def _body(name: str, position: list[float], rotation: list[float]) -> Body:
    x, y, z, w = rotation
    return Body(name, (position[0], position[1], position[2]), (x, y, z, w))


def _options(settings: TrackerSettings) -> dict[str, str]:
    """The library's own settings; those that the experiment does not give are the library's."""
    options = dict(option.partition("=")[::2] for option in settings.options)
    if settings.server:
        options["hostname"] = settings.server
    if settings.command_port:
        options["port_command"] = str(settings.command_port)
    return options


SYSTEM = TrackingSystem(lambda setup: closing(MotionCaptureTracker(setup.experiment)))


def tell(system: str, options: dict[str, str], telling: int) -> None:
    """The child: a line for every frame, with the monotonic time at which it came, until nobody reads it."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    import motioncapture

    client = motioncapture.connect(system, options)
    with open(telling, "w", encoding="utf-8") as lines:
        while True:
            client.waitForNextFrame()
            bodies = [_told(name, body) for name, body in client.rigidBodies.items()]
            lines.write(json.dumps([time.monotonic_ns(), [body for body in bodies if body]]) + "\n")
            lines.flush()


def _told(name: str, body: Any) -> tuple[str, list[float], list[float]] | None:
    """A body's name, place and rotation; None if it is lost, which the library tells by no number."""
    position, rotation = [float(part) for part in body.position], body.rotation
    turned = [rotation.x, rotation.y, rotation.z, rotation.w]
    return (name, position, turned) if finite((*position, *turned)) else None


if __name__ == "__main__":
    tell(sys.argv[1], json.loads(sys.argv[2]), int(sys.argv[3]))
