"""The drivers by the name that an experiment file gives them: a new driver adds one line."""

from __future__ import annotations

from collections.abc import Callable

from robot_agent.drivers.interfaces import Driver, DriverParts
from robot_agent.drivers.sim.robot import SimulatedDriver
from swarm.errors import UserError, nearest

DRIVERS: dict[str, Callable[[DriverParts], Driver]] = {
    "sim": SimulatedDriver,
}


def driver_names() -> list[str]:
    """What an experiment file may call a driver."""
    return list(DRIVERS)


def make_driver(parts: DriverParts) -> Driver:
    """The driver that the robot's settings name."""
    name = parts.robot.driver
    if name not in DRIVERS:
        raise UserError(f"robot {parts.robot.id!r}: driver is {name!r}; {nearest(name, DRIVERS)}")
    return DRIVERS[name](parts)
