"""The drivers of real e-pucks, one for each link: they differ in who opens the link and what that needs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.interfaces import Camera, DriverParts
from robot_agent.drivers.watchdog_process import WatchdogProcess
from robot_agent.vision.camera_model import CameraModel
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics


@dataclass(frozen=True)
class LinkKind:
    """A kind of link: where it is opened, and the package and extra that it needs."""

    opener: str
    """MODULE:FUNCTION, which takes the robot's address; loaded by the watchdog alone."""
    package: str = ""
    needs_address: str = ""
    """An example of the address, if there is none that can be guessed."""
    has_camera: bool = False
    """Whether images come over the link."""


KINDS = {
    "serial": LinkKind(
        "robot_agent.drivers.serial:open_link",
        package="serial",
        needs_address="/dev/ttyACM0 or 10:00:E8:AD:12:34",
        has_camera=True,
    ),
    "wifi": LinkKind("robot_agent.drivers.wifi:open_link", needs_address="192.168.1.20", has_camera=True),
    "i2c": LinkKind("robot_agent.drivers.i2c:open_link", "smbus2"),
    "spi": LinkKind("robot_agent.drivers.spi:open_link", "spidev"),
}


def opener_of(link: str) -> str:
    """Where a link is opened, as MODULE:FUNCTION."""
    return KINDS[link].opener


def require_package(link: str, address: str) -> None:
    """UserError that names the extra, if the link's package is not installed. An emulated SPI device needs
    none."""
    package = KINDS[link].package
    if package and not _is_installed(package) and not (link == "spi" and address.startswith("unix:")):
        raise UserError(f"driver {link!r} needs {package}: pip install 'swarm-runtime[{link}]'")


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:
        return False


def now_at(speed: float) -> Callable[[], int]:
    """The machine's monotonic clock, run at the run's speed: what agent and watchdog have in common."""
    return lambda: int(time.monotonic_ns() * speed)


class EpuckDriver:
    """A real e-puck. Its camera has a driver of its own."""

    def __init__(self, link: str, parts: DriverParts) -> None:
        robot, kind = parts.robot, KINDS[link]
        self._has_camera = kind.has_camera
        if parts.lockstep:
            raise UserError(
                f"robot {robot.id!r}: driver {link!r} keeps its own time; use --emulate and --speed X"
            )
        if kind.needs_address and not parts.address:
            raise UserError(f"robot {robot.id!r} has no address, for instance {kind.needs_address}")
        require_package(link, parts.address)
        self._parts = parts
        channel = WatchdogProcess(kind.opener, parts.address, parts.speed)
        self.body = EpuckBody(channel, parts.geometry, now_at(parts.speed), parts.speed, self._say)
        try:
            self.body.wait_for_robot()
        except UserError as error:
            self.body.close()
            raise UserError(f"robot {robot.id!r}, {link} {parts.address}: {error}") from error

    def camera(self, model: CameraModel) -> Camera:
        """The camera that the settings name; what it takes is loaded here and not before."""
        from robot_agent.drivers.cameras.choice import camera_named

        on_link = self.body.take_picture if self._has_camera else None
        return camera_named(self._parts.robot.camera, on_link, model, self._parts.speed, self._say)

    def _say(self, name: str, text: str) -> None:
        """An event for the log; what the robot says of itself is no warning."""
        level = pb.Event.INFO if name == "robot" else pb.Event.WARNING
        event = pb.Event(level=level, name=name, text=text)
        self._parts.node.publish(topics.EVENT, event, self._parts.robot.id)


serial = partial(EpuckDriver, "serial")
wifi = partial(EpuckDriver, "wifi")
i2c = partial(EpuckDriver, "i2c")
spi = partial(EpuckDriver, "spi")
