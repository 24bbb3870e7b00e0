"""Which drivers, tracking systems, checks and cameras of logs there are: what ships, and of other packages.

A package of somebody's own joins by an entry point in a group. What ships is named here, so that an
updated checkout finds it without being installed anew; a name that ships cannot be taken. Nothing is
imported to know the names.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

DRIVERS = "swarm.drivers"
"""Functions or classes that take `robot_agent.drivers.interfaces.DriverParts` and return a `Driver`."""
TRACKERS = "swarm.trackers"
"""Objects of `tracker_bridge.backends.interface.TrackingSystem`."""
CHECKS = "swarm.checks"
"""Functions that take an `Experiment` and give findings, before anything starts."""

FRAMES = "swarm.frames"
"""By driver, functions like `swarm.film.camera.Retaking`: what a robot's camera saw, from a log."""

SHIPPED = {
    CHECKS: {
        "robot_agent": "robot_agent.checks:checks",
        "tracker_bridge": "tracker_bridge.checks:checks",
    },
    DRIVERS: {
        "sim": "robot_agent.drivers.sim.robot:SimulatedDriver",
        "serial": "robot_agent.drivers.epuck_driver:serial",
        "wifi": "robot_agent.drivers.epuck_driver:wifi",
        "i2c": "robot_agent.drivers.epuck_driver:i2c",
        "spi": "robot_agent.drivers.epuck_driver:spi",
    },
    FRAMES: {"sim": "robot_agent.offline.retaken:retaken_frames"},
    TRACKERS: {
        "sim": "tracker_bridge.backends.sim:SYSTEM",
        "vicon": "tracker_bridge.backends.vicon:SYSTEM",
        "natnet": "tracker_bridge.backends.natnet:SYSTEM",
        "natnet-hats": "tracker_bridge.backends.natnet_hats:SYSTEM",
        "overhead": "tracker_bridge.backends.overhead:SYSTEM",
        "overhead-sim": "tracker_bridge.backends.overhead_sim:SYSTEM",
        "replay": "tracker_bridge.backends.replay:SYSTEM",
        "motioncapture": "tracker_bridge.backends.motioncapture:SYSTEM",
    },
}


def plugins(group: str) -> dict[str, EntryPoint]:
    """What can be named in an experiment file, by name; `load()` imports it."""
    installed = {entry.name: entry for entry in entry_points(group=group)}
    shipped = {name: EntryPoint(name, place, group) for name, place in SHIPPED[group].items()}
    return installed | shipped
