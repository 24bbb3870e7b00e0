"""Puts an emulated robot together: wheels, firmware, and the port where it can be reached."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.motors import EPUCK1, EPUCK2, YORK, StepperMotors
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.emulator.asercom import Asercom
from robot_agent.emulator.esp32 import SENSORS_EVERY_NS, Esp32
from robot_agent.emulator.faults import Faults
from robot_agent.emulator.i2c_slaves import GumstixSlave, I2cSlave, YorkSlave
from robot_agent.emulator.lpuck import LpuckSlave
from robot_agent.emulator.ports import EMULATED, LOOPBACK, BusPort, Port, SerialPort, WifiPort
from robot_agent.emulator.robot import EmulatedRobot
from swarm.geometry import Compartment, Pose

LINKS = ("serial", "wifi", "i2c", "spi")
MODELS = ("epuck1", "epuck2")
SELECTORS = {"serial": 3, "wifi": 15, "i2c": 10, "spi": 10}
"""Where each link's firmware needs the selector to be."""
FASTEST_STEPS_PER_S = 1200.0
"""Above all firmwares' limits: here nothing is clipped but by the firmware."""


@dataclass(frozen=True)
class RobotToEmulate:
    """Which robot is emulated, where it stands, and what goes wrong with it."""

    link: str
    walls: Compartment
    pose: Pose
    model: str = "epuck2"
    body: BodyFaults = field(default_factory=lambda: BodyFaults(0.0, 0.0, 0.0))
    faults: Faults = field(default_factory=Faults)
    wifi_cycle_ns: int = SENSORS_EVERY_NS


def default_address(link: str, place: Path, name: str) -> str:
    """An address in a folder; a free port of this machine for Wi-Fi."""
    if link == "wifi":
        return f"{LOOPBACK}:0"
    return f"{EMULATED if link in ('i2c', 'spi') else ''}{place / name}.{link}"


class Emulation:
    """One robot and its port; a context manager that serves for as long as the block runs."""

    def __init__(
        self,
        wanted: RobotToEmulate,
        address: str,
        now_ns: Callable[[], int],
        rng: np.random.Generator,
    ) -> None:
        body_rng, link_rng = rng.spawn(2)
        geometry = EpuckGeometry(max_steps_per_s=FASTEST_STEPS_PER_S)
        body = SimulatedBody(geometry, wanted.body, wanted.pose, wanted.walls, body_rng)
        self.robot = EmulatedRobot(body, _motors(wanted), wanted.walls, wanted.faults, SELECTORS[wanted.link])
        self.now_ns = now_ns
        self.lock = threading.Lock()
        """Held by whoever touches the robot while it is served."""
        self.port = _port(wanted, self.robot, address, now_ns, self.lock, link_rng)

    @property
    def address(self) -> str:
        """What a driver is to be given as the robot's address."""
        return self.port.address

    def __enter__(self) -> Emulation:
        self.port.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self.port.close()


def _motors(wanted: RobotToEmulate) -> StepperMotors:
    if wanted.model == "epuck2" and wanted.link != "spi":
        return EPUCK2
    return YORK if wanted.link == "i2c" else EPUCK1


def _port(
    wanted: RobotToEmulate,
    robot: EmulatedRobot,
    address: str,
    now_ns: Callable[[], int],
    lock: threading.Lock,
    rng: np.random.Generator,
) -> Port:
    """The port of a link at an address such as a driver is given."""
    faults, at = wanted.faults, Path(address.removeprefix(EMULATED))
    if wanted.link == "serial":
        firmware = Asercom(robot, wanted.model, rng)
        return SerialPort(firmware, at, now_ns, lock, faults)
    if wanted.link == "wifi":
        host, _, number = address.rpartition(":")
        esp32, where = Esp32(robot, rng, wanted.wifi_cycle_ns), (host or LOOPBACK, int(number))
        return WifiPort(esp32, where, now_ns, lock, faults)
    if wanted.link == "spi":
        lpuck = LpuckSlave(robot, rng)
        return BusPort(None, lambda sent: lpuck.transfer(sent, now_ns()), at, now_ns, lock, faults)
    slave: I2cSlave = GumstixSlave(robot, rng) if wanted.model == "epuck2" else YorkSlave(robot, rng)

    def i2c(address: int, written: bytes, count: int) -> bytes:
        return slave.transfer(address, written, count, now_ns())

    return BusPort(i2c, None, at, now_ns, lock, faults)
