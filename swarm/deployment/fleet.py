"""Which machines a laboratory has, and what each of them hosts."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory, Machine, RobotMachine

AGENT = "swarm-agent@"
BRIDGE = "swarm-bridge"
SERVER = "swarm-server"
DRIVER_EXTRAS = {"serial": "serial", "i2c": "i2c", "spi": "spi"}
TRACKER_EXTRAS = {"motioncapture": "mocap", "overhead": "vision", "overhead-sim": "vision"}
"""Extras of the package that a driver or a tracking system needs."""


@dataclass(frozen=True)
class Target:
    """A machine and what it hosts."""

    machine: Machine
    robots: tuple[RobotMachine, ...]
    tracking_system: str | None
    """The tracking system whose bridge it hosts; None if it hosts no bridge."""
    conducts: bool
    """Whether the server is there."""

    @property
    def name(self) -> str:
        """For people: what it hosts, and where it is."""
        hosted = [robot.id for robot in self.robots]
        hosted += ["tracker"] if self.tracking_system is not None else []
        hosted += ["server"] if self.conducts else []
        return f"{', '.join(hosted)} on {self.machine.host}"

    def extras(self, experiment: Experiment | None) -> frozenset[str]:
        """Extras of the package that have to be installed there, for an experiment if there is one."""
        found = {DRIVER_EXTRAS.get(robot.driver, "") for robot in self.robots}
        found.add(TRACKER_EXTRAS.get(self.tracking_system or "", ""))
        found.add("lab" if self.conducts else "")
        found.update("vision" for robot in self.robots if robot.calibration)
        for robot in experiment.robot if experiment else ():
            if robot.id in {hosted.id for hosted in self.robots}:
                found.add("vision" if robot.watches else "")
                found.add("camera" if robot.camera.startswith("/dev/") else "")
        return frozenset(found - {""})

    @property
    def units(self) -> list[str]:
        """The names of the unit files that its services are started from."""
        everything = self.services([robot.id for robot in self.robots], run=True)
        return sorted({f"{AGENT}.service" if name.startswith(AGENT) else name for name in everything})

    def services(self, taking_part: Collection[str], run: bool) -> list[str]:
        """The services to start for an experiment with these robots.

        The server, and a bridge that it hosts, belong to a run: they come first, and only if it is to begin.
        """
        server = [f"{SERVER}.service"] if self.conducts and run else []
        hosts_bridge = self.tracking_system is not None and (run or not self.conducts)
        bridge = [f"{BRIDGE}.service"] if hosts_bridge else []
        return (
            server
            + bridge
            + [f"{AGENT}{robot.id}.service" for robot in self.robots if robot.id in taking_part]
        )


def targets(laboratory: Laboratory) -> list[Target]:
    """Every machine once, whatever it hosts; the server's first."""
    everything = [laboratory.server, laboratory.bridge, *laboratory.robot]
    machines = {machine.login: machine for machine in reversed(everything)}
    backend = laboratory.tracker.backend if laboratory.tracker else ""
    return [
        Target(
            machine,
            tuple(robot for robot in laboratory.robot if robot.login == login),
            backend if laboratory.bridge.login == login else None,
            laboratory.server.login == login,
        )
        for login, machine in reversed(machines.items())
    ]
