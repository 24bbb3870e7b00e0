"""What a laboratory file says: its machines, how to reach them, and the robots that stand before them.

`Laboratory.load` is the one door: it also checks what no single value shows, and that nothing in the file
could be taken for something else by a shell, by SSH or by systemd on the way to a machine.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from swarm.config.laboratory_consistency import check_laboratory
from swarm.config.toml_files import Between, ConfigFile


class Services(StrEnum):
    """Who starts the processes of a machine, and starts them again."""

    SYSTEM = "systemd"
    """systemd; the user has to be root, or one who may call systemctl by sudo without a password."""
    SUPERVISED = "supervised"
    """A supervisor of this package, for machines without systemd; it ends with the machine."""


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A machine that is reached over SSH."""

    host: str
    """Its name or address."""
    user: str = "swarm"
    """Who logs in, by a key that ssh knows; and whose the files and processes are."""
    ssh_port: Annotated[int, Between(1, 65_535)] = 22
    """Where its SSH server listens."""
    python: str = "python3"
    """Its Python, 3.11 or newer: a command or a path."""
    directory: str = "swarm"
    """Where everything goes: from the user's home, if it does not begin with /."""

    @property
    def login(self) -> tuple[str, str, int]:
        """What tells machines apart."""
        return self.user, self.host, self.ssh_port


@dataclass(frozen=True, kw_only=True)
class LaboratorySettings:
    """[laboratory]: its name."""

    name: str
    """An id: it also names the authority that signs the laboratory's certificates."""


@dataclass(frozen=True, kw_only=True)
class ServerMachine(Machine):
    """[server]: the machine that conducts runs and records them; the others take their time from it."""

    port: Annotated[int, Between(1, 65_535)] = 7447
    """Where the hub listens for robots and tracker bridge."""


@dataclass(frozen=True, kw_only=True)
class TrackerMachine(Machine):
    """[tracker]: the machine beside the tracking system; leave it out if the server hosts the bridge."""

    backend: str = "sim"
    """The tracking system, as in an experiment's [tracker]."""


@dataclass(frozen=True, kw_only=True)
class RobotMachine(Machine):
    """[[robot]]: a robot, and the machine that its agent runs on. A gateway may host several."""

    id: str
    """The robot's name, as in experiments."""
    driver: str
    """What moves it: serial, wifi, i2c, spi, or one of your own."""
    address: str = ""
    """Where the driver finds the robot, as in experiments."""
    wheel_diameter_m: Annotated[float, Between(0.03, 0.06)] = 0.041
    """Of its wheels, as calibrated."""
    wheel_base_m: Annotated[float, Between(0.04, 0.07)] = 0.053
    """Between its wheels, as calibrated."""
    calibration: Path | None = None
    """Its camera's calibration file, beside this one; it is copied to the machine."""
    skirt: str = "red"
    """The colour of its skirt."""
    south_west_m: tuple[float, float]
    """Where its compartment begins in the arena."""


@dataclass(frozen=True, kw_only=True)
class VersionSettings:
    """[versions]: what all machines must run."""

    program: str = ""
    """The version of swarm-runtime; that of the command that deploys if empty."""
    messages: str = ""
    """The digest of the message types, as `swarm lab check --json` tells it; likewise."""


@dataclass(frozen=True, kw_only=True)
class PolicySettings:
    """[policies]: how machines are kept."""

    services: Services = Services.SYSTEM
    """Who starts the processes."""
    keep_releases: Annotated[int, Between(2, 20)] = 3
    """Releases that stay on a machine, for `swarm deploy --rollback`; older ones are removed."""
    healthy_within_s: Annotated[float, Between(1, 600)] = 60.0
    """A machine whose processes have not said by then that they are ready goes back to its last release."""
    known_hosts: Path | None = None
    """The host keys that are believed, as ssh-keyscan prints them; ~/.ssh/known_hosts if not given."""


@dataclass(frozen=True)
class Laboratory:
    """A laboratory file, checked."""

    laboratory: LaboratorySettings
    server: ServerMachine
    robot: tuple[RobotMachine, ...]
    tracker: TrackerMachine | None = None
    versions: VersionSettings = field(default_factory=VersionSettings)
    policies: PolicySettings = field(default_factory=PolicySettings)

    @classmethod
    def load(cls, path: Path) -> Laboratory:
        """Read and check a laboratory file; UserError names the file, the line and the cure."""
        file = ConfigFile(path)
        laboratory = file.settings(cls)
        check_laboratory(laboratory, file)
        return laboratory

    @property
    def bridge(self) -> Machine:
        """The machine that hosts the tracker bridge."""
        return self.tracker or self.server

    @property
    def server_address(self) -> str:
        """HOST:PORT of the hub, for an endpoint such as tcp/HOST:PORT."""
        host = self.server.host
        return f"{f'[{host}]' if ':' in host else host}:{self.server.port}"

    def robot_named(self, name: str) -> RobotMachine:
        return next(robot for robot in self.robot if robot.id == name)
