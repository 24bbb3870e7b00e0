"""The drivers of real e-pucks, one for each link: they differ in who opens the link and what that needs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.interfaces import Camera, DriverParts
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.notices import Say
from robot_agent.drivers.watchdog_process import WatchdogProcess
from robot_agent.vision.camera_model import CameraModel
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics


@dataclass(frozen=True)
class LinkKind:
    """A kind of link: where it is opened, and what it needs."""

    opener: str
    """MODULE:FUNCTION, which takes the robot's address and gives a `RobotLink`; the watchdog loads it."""
    package: str = ""
    extra: str = ""
    """The package that it needs, and the extra of this project that installs it."""
    needs_address: str = ""
    """An example of the address, if there is none that can be guessed."""
    has_camera: bool = False
    """Whether images come over the link."""


KINDS = {
    "serial": LinkKind(
        "robot_agent.drivers.serial:open_link",
        package="serial",
        extra="serial",
        needs_address="/dev/ttyACM0 or 10:00:E8:AD:12:34",
        has_camera=True,
    ),
    "wifi": LinkKind("robot_agent.drivers.wifi:open_link", needs_address="192.168.1.20", has_camera=True),
    "i2c": LinkKind("robot_agent.drivers.i2c:open_link", package="smbus2", extra="i2c"),
    "spi": LinkKind("robot_agent.drivers.spi:open_link", package="spidev", extra="spi"),
}
EMULATED_DEVICE = "unix:"
"""An emulated SPI device needs no package; smbus2's messages are used on an emulated bus, too."""


def now_at(speed: float) -> Callable[[], int]:
    """The machine's monotonic clock, run at the run's speed: what agent and watchdog have in common."""
    return lambda: int(time.monotonic_ns() * speed)


def opened_body(kind: LinkKind, address: str, geometry: EpuckGeometry, speed: float, say: Say) -> EpuckBody:
    """A body with a watchdog of its own; the robot has not answered yet.

    UserError if the address or the link's package is missing.
    """
    if kind.needs_address and not address:
        raise UserError(f"the robot has no address, for instance {kind.needs_address}")
    is_emulated = kind.package == "spidev" and address.startswith(EMULATED_DEVICE)
    if kind.package and not is_emulated and not _is_installed(kind.package):
        cure = f"pip install 'swarm-runtime[{kind.extra}]'" if kind.extra else f"pip install {kind.package}"
        raise UserError(f"the link needs {kind.package}: {cure}")
    channel = WatchdogProcess(kind.opener, address, speed)
    return EpuckBody(channel, geometry, now_at(speed), speed, say)


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:
        return False


class EpuckDriver:
    """A real robot with two wheels that count their steps, over one kind of link."""

    def __init__(self, kind: LinkKind, parts: DriverParts) -> None:
        robot = parts.robot
        if parts.lockstep:
            raise UserError(
                f"robot {robot.id!r}: driver {robot.driver!r} keeps its own time; use --emulate and --speed X"
            )
        self._kind = kind
        self._parts = parts
        try:
            self.body = opened_body(kind, parts.address, parts.geometry, parts.speed, self._say)
            self._wait_for_robot()
        except UserError as error:
            raise UserError(f"robot {robot.id!r}, {robot.driver} {parts.address}: {error}") from error

    def camera(self, model: CameraModel) -> Camera:
        """The camera that the settings name; what it takes is loaded here and not before."""
        from robot_agent.drivers.cameras.choice import camera_named

        on_link = self.body.take_picture if self._kind.has_camera else None
        return camera_named(self._parts.robot.camera, on_link, model, self._parts.speed, self._say)

    def _wait_for_robot(self) -> None:
        try:
            self.body.wait_for_robot()
        except UserError:
            self.body.close()
            raise

    def _say(self, name: str, text: str) -> None:
        """An event for the log; what the robot says of itself is no warning."""
        level = pb.Event.INFO if name == "robot" else pb.Event.WARNING
        event = pb.Event(level=level, name=name, text=text)
        self._parts.node.publish(topics.EVENT, event, self._parts.robot.id)


serial = partial(EpuckDriver, KINDS["serial"])
wifi = partial(EpuckDriver, KINDS["wifi"])
i2c = partial(EpuckDriver, KINDS["i2c"])
spi = partial(EpuckDriver, KINDS["spi"])
