"""The drivers by the name that an experiment file gives them: built in, or of an installed package.

A package of somebody's own joins by an entry point in the group `swarm.drivers` that names a function (or
class) which takes `DriverParts` and returns a `Driver`.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points

from robot_agent.drivers.interfaces import Driver, DriverParts
from swarm.errors import UserError, nearest

GROUP = "swarm.drivers"
_BUILT_IN = {
    "sim": "robot_agent.drivers.sim.robot:SimulatedDriver",
    "serial": "robot_agent.drivers.epuck_driver:serial",
    "wifi": "robot_agent.drivers.epuck_driver:wifi",
    "i2c": "robot_agent.drivers.epuck_driver:i2c",
    "spi": "robot_agent.drivers.epuck_driver:spi",
}


def make_driver(parts: DriverParts) -> Driver:
    """The driver that the robot's settings name; only its module is loaded."""
    name = parts.robot.driver
    found = _BUILT_IN.get(name)
    entry = EntryPoint(name, found, GROUP) if found else _installed(name, parts.robot.id)
    make: Callable[[DriverParts], Driver] = entry.load()
    return make(parts)


def _installed(name: str, robot: str) -> EntryPoint:
    others = {entry.name: entry for entry in entry_points(group=GROUP)}
    if name not in others:
        raise UserError(f"robot {robot!r}: driver is {name!r}; {nearest(name, [*_BUILT_IN, *others])}")
    return others[name]
