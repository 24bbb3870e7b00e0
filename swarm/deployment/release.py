"""What runs on a machine besides the program: its units, what they are started with, and the experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path, PurePosixPath

from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory, RobotMachine
from swarm.deployment.fleet import Target
from swarm.errors import UserError

EXPERIMENT = "experiment.toml"
UNITS_ROOT, UNITS_USER = "/home/swarm/swarm", "User=swarm"
"""What the units that ship are written for."""
EVERYWHERE = "0.0.0.0"
"""The server listens on every network that its machine has: a name in /etc/hosts may lead to its loopback."""
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


def release_files(target: Target, laboratory: Laboratory, root: str, experiment: Files) -> dict[str, bytes]:
    """Everything but the program that a machine runs with, by name below the release's folder.

    `root` is the machine's directory, from the root of its files.
    """
    found = dict(experiment)
    for name in target.units:
        text = files("swarm.deployment").joinpath("systemd", name).read_text(encoding="utf-8")
        text = text.replace(UNITS_ROOT, root).replace(UNITS_USER, f"User={target.machine.user}")
        found[f"units/{name}"] = text.encode()
    there = f"tcp/{laboratory.server_address}"
    for robot in target.robots:
        found[f"agent-{robot.id}.env"] = _environment(there, _agent_options(robot))
        if robot.calibration:
            found[_calibration_name(robot)] = robot.calibration.read_bytes()
    if target.tracking_system is not None:
        found["bridge.env"] = _environment(there, [])
    if target.conducts:
        found["server.env"] = _environment(f"tcp/{EVERYWHERE}:{laboratory.server.port}", [])
    return found


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


def _environment(endpoint: str, options: list[str]) -> bytes:
    return f"SWARM_ENDPOINT={endpoint}\nSWARM_OPTIONS={' '.join(options)}\n".encode()


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
