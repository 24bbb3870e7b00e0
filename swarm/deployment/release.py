"""What runs on a machine besides the program: its units, what they are started with, and the experiment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path, PurePosixPath

from swarm.access.identities import SERVER, TRACKER, Identity
from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory, RobotMachine
from swarm.deployment.fleet import Target
from swarm.errors import UserError
from swarm.messages.topics import Role

EXPERIMENT = "experiment.toml"
UNITS_ROOT, UNITS_USER = "/home/swarm/swarm", "User=swarm"
"""What the units that ship are written for."""
EVERYWHERE = "0.0.0.0"
"""The server listens on every network that its machine has: a name in /etc/hosts may lead to its loopback."""
CREDENTIALS = "credentials"
"""A process's folder of keys is below this one."""
CHRONY_SERVER = "server.laboratory"
"""What a board's clock settings that ship call the server."""
ID_DIGITS = 12
"""Two of a laboratory's releases have the same id once in 10^14 pairs."""

Files = Mapping[str, bytes]


@dataclass(frozen=True)
class ExperimentFiles:
    """An experiment as machines get it: its text and the files that it names, by their names there."""

    experiment: Experiment
    files: Files

    @classmethod
    def read(cls, path: Path) -> ExperimentFiles:
        """UserError if a file is missing, or has a name that only this machine understands."""
        experiment = Experiment.load(path)
        named = (experiment.camera.calibration, experiment.camera.colours, experiment.tracker.file)
        contents = {_name_there(name, path): _content(Path(name), path) for name in named if name}
        return cls(experiment, {EXPERIMENT: path.read_bytes(), **contents})


@dataclass(frozen=True)
class Protection:
    """How processes show who they are: by what is in the folder that `swarm lab keys` makes, or not."""

    keys: Path | None

    @classmethod
    def of(cls, keys: Path, insecure: bool) -> Protection:
        """UserError if there are no keys and nobody said that there need be none."""
        if keys.is_dir() != insecure:
            return cls(None if insecure else keys)
        if insecure:
            raise UserError(f"--insecure: there are keys in {keys}, and they are used")
        raise UserError(
            f"{keys} is not there: make it with `swarm lab keys`, or say --insecure on a network of your own"
        )

    @property
    def protocol(self) -> str:
        return "tls" if self.keys else "tcp"

    def files(self, identity: Identity) -> dict[str, bytes]:
        """What a process is given to show; UserError if there is nothing, as of somebody who was shut out."""
        if not self.keys:
            return {}
        folder = self.keys / str(identity)
        found = {f"{CREDENTIALS}/{identity}/{file.name}": file.read_bytes() for file in folder.glob("*")}
        if not found:
            raise UserError(
                f"{folder} is not there: `swarm lab keys` makes it, with --renew if it was revoked"
            )
        return found

    def options(self, identity: Identity, root: str) -> list[str]:
        """What a process is started with on a machine with this directory."""
        place = f"{root}/current/{CREDENTIALS}/{identity}"
        return ["--credentials", place] if self.keys else ["--insecure"]


def release_files(
    target: Target, laboratory: Laboratory, protection: Protection, root: str, experiment: Files
) -> dict[str, bytes]:
    """Everything but the program that a machine runs with, by name below the release's folder.

    `root` is the machine's directory, from the root of its files.
    """
    found = dict(experiment)
    for name in target.units:
        text = files("swarm.deployment").joinpath("systemd", name).read_text(encoding="utf-8")
        text = text.replace(UNITS_ROOT, root).replace(UNITS_USER, f"User={target.machine.user}")
        found[f"units/{name}"] = text.encode()
    found["chrony.conf"] = _clock(target, laboratory)
    hub, everywhere = laboratory.server_address, f"{EVERYWHERE}:{laboratory.server.port}"
    for robot in target.robots:
        who, options = Identity(Role.ROBOT, robot.id), _agent_options(robot)
        found |= _process(f"agent-{robot.id}", hub, protection, who, root, options)
        if robot.calibration:
            found[_calibration_name(robot)] = robot.calibration.read_bytes()
    if target.tracking_system is not None:
        found |= _process("bridge", hub, protection, TRACKER, root)
    if target.conducts:
        found |= _process("server", everywhere, protection, SERVER, root)
    return found


def _clock(target: Target, laboratory: Laboratory) -> bytes:
    """From whom a machine takes its time."""
    name = "server.conf" if target.conducts else "board.conf"
    text = files("swarm.deployment").joinpath("chrony", name).read_text(encoding="utf-8")
    return text.replace(CHRONY_SERVER, laboratory.server.host).encode()


def _process(
    name: str, address: str, protection: Protection, who: Identity, root: str, options: Sequence[str] = ()
) -> dict[str, bytes]:
    """What a process is started with, and its credentials."""
    words = " ".join([*options, *protection.options(who, root)])
    text = f"SWARM_ENDPOINT={protection.protocol}/{address}\nSWARM_OPTIONS={words}\n"
    return {f"{name}.env": text.encode(), **protection.files(who)}


def release_id(program: str, contents: Files, services: list[str]) -> str:
    """The same for the same program, files and services."""
    digest = sha256(repr((program, services)).encode())
    for name, content in sorted(contents.items()):
        digest.update(f"{name} {sha256(content).hexdigest()}\n".encode())
    return digest.hexdigest()[:ID_DIGITS]


def _agent_options(robot: RobotMachine) -> list[str]:
    options = ["--address", f"{robot.id}={robot.address}"] if robot.address else []
    return options + (["--calibration", _calibration_name(robot)] if robot.calibration else [])


def _calibration_name(robot: RobotMachine) -> str:
    return f"camera-{robot.id}.toml"


def _name_there(name: str, experiment: Path) -> str:
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts:
        raise UserError(
            f"{experiment}: {name} is not below the folder that the experiment is started from: move it there"
        )
    return str(path)


def _content(file: Path, experiment: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise UserError(f"{experiment}: {file}: {error.strerror}") from error
