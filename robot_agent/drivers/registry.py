"""The drivers by the name that an experiment file gives them: built in, or of an installed package.

A package of somebody's own joins by an entry point in the group `swarm.drivers` that names a function (or
class) which takes `DriverParts` and returns a `Driver`.
"""

from __future__ import annotations

from collections.abc import Callable

from robot_agent.drivers.interfaces import Driver, DriverParts
from swarm.errors import UserError, nearest
from swarm.plugins import DRIVERS, plugins


def make_driver(parts: DriverParts) -> Driver:
    """The driver that the robot's settings name; only its module is loaded."""
    name, known = parts.robot.driver, plugins(DRIVERS)
    if name not in known:
        raise UserError(f"robot {parts.robot.id!r}: driver is {name!r}; {nearest(name, known)}")
    make: Callable[[DriverParts], Driver] = known[name].load()
    return make(parts)
