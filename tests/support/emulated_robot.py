"""An e-puck body with emulated firmware at the other end of its link, in time that passes as a test says."""

from __future__ import annotations

from collections import deque
from pathlib import Path

import numpy as np

from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.epuck_driver import KINDS
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.robot_link import RobotLink
from robot_agent.drivers.watchdog import Watchdog, link_opener
from robot_agent.drivers.watchdog_messages import Request
from robot_agent.emulator.emulation import Emulation, RobotToEmulate, default_address
from robot_agent.emulator.faults import Faults
from swarm.geometry import Compartment, Grid, Pose

HALL = Compartment(0.0, 0.0, Grid(100, 100), 0.12)
"""Walls far enough away for whatever a test drives."""
MIDDLE = Pose(6.0, 6.0, 0.0)
STEP_NS = 20_000_000
LINKS = (
    ("serial", "epuck1"),
    ("serial", "epuck2"),
    ("wifi", "epuck2"),
    ("i2c", "epuck2"),
    ("i2c", "epuck1"),
    ("spi", "epuck1"),
)
"""Every link with every robot that it reaches."""


class Clock:
    """Time that stands until it is set."""

    def __init__(self, t_ns: int) -> None:
        self.t_ns = t_ns

    def now_ns(self) -> int:
        return self.t_ns


class LocalChannel:
    """A watchdog in this process: it answers at once."""

    def __init__(self, watchdog: Watchdog, heard: deque[bytes]) -> None:
        self._watchdog = watchdog
        self._heard = heard

    def send(self, message: bytes) -> None:
        self._heard.append(self._watchdog.obey(Request.unpack(message)).pack())

    def receive(self, within_s: float) -> bytes | None:  # noqa: ARG002
        return self._heard.popleft() if self._heard else None

    def restart(self) -> None:
        raise AssertionError("this watchdog never ends")

    def close(self) -> None:
        self._watchdog.stand()


class EmulatedRig:
    """A robot behind real bytes, a real watchdog's rules, and a body."""

    def __init__(
        self, link: str, model: str, place: Path, faults: Faults | None = None, t_ns: int = 1_000_000_000
    ) -> None:
        self.geometry = EpuckGeometry()
        self.events: list[tuple[str, str]] = []
        self.clock = Clock(t_ns)
        wanted = RobotToEmulate(link, HALL, MIDDLE, model, faults=faults or Faults(), wifi_cycle_ns=0)
        self.emulation = Emulation(
            wanted, default_address(link, place, "robot"), self.clock.now_ns, np.random.default_rng(1)
        )
        self.emulation.__enter__()
        heard: deque[bytes] = deque()
        self.watchdog = Watchdog(lambda: self._opened(link), self.clock.now_ns, heard.append)
        channel = LocalChannel(self.watchdog, heard)
        self.body = EpuckBody(
            channel, self.geometry, self.clock.now_ns, 1.0, lambda *event: self.events.append(event)
        )
        self.identity = self.body.wait_for_robot()

    def _opened(self, link: str) -> RobotLink:
        return link_opener(KINDS[link].opener)(self.emulation.address)

    def run_to(self, t_ns: int) -> None:
        """Let time pass, and the watchdog do what it has to do by itself."""
        # A second exchange ends only when the firmware has obeyed the command of the first.
        self.watchdog.act()
        while self.clock.t_ns < t_ns:
            due_ns = max(self.clock.t_ns, self.watchdog.due_ns)
            self.clock.t_ns = min(t_ns, self.clock.t_ns + STEP_NS, max(due_ns, self.clock.t_ns + 1))
            if self.watchdog.due_ns <= self.clock.t_ns:
                self.watchdog.act()

    def motors_stand(self, t_ns: int) -> bool:  # noqa: ARG002
        return self.emulation.robot.commanded == (0, 0)

    def close(self) -> None:
        self.watchdog.close()
        self.emulation.__exit__()
