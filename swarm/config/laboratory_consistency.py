"""What no single value of a laboratory file shows, and names that would be something else further on."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from swarm.config.ids import check_id, check_robot_id
from swarm.config.toml_files import ConfigFile

if TYPE_CHECKING:
    from swarm.config.laboratory import Laboratory, Machine, RobotMachine

Place = tuple[str | int, ...]

_PATTERNS = {
    "host": (re.compile(r"[A-Za-z0-9][A-Za-z0-9.:_-]{0,252}"), "letters, digits, dots, colons, _ and -"),
    "user": (re.compile(r"[a-z_][a-z0-9_-]{0,31}"), "small letters, digits, _ and -"),
    "python": (re.compile(r"/?[A-Za-z0-9][A-Za-z0-9._/-]*"), "letters, digits, and . _ / -"),
    "directory": (re.compile(r"/?[A-Za-z0-9][A-Za-z0-9._/-]*"), "letters, digits, and . _ / -"),
}
"""What each name of a machine may be: nothing that a shell, ssh or a systemd unit reads as its own."""


_WORD = re.compile(r"[A-Za-z0-9._:/-]*")
"""What goes into a unit's command: one word, and none that systemd reads as its own."""


def check_laboratory(laboratory: Laboratory, file: ConfigFile) -> None:
    """UserError, with its line in the file, about what no single value shows."""
    check_id(laboratory.laboratory.name, ("laboratory", "name"), file)
    if not laboratory.robot:
        raise file.error(("robot",), "there is no robot: write [[robot]] and its id, host and driver")
    for where, machine in _machines(laboratory):
        _check_names(machine, where, file)
    for number, robot in enumerate(laboratory.robot):
        _check_robot(laboratory, number, robot, file)
    _check_shared_machines(laboratory, file)


def _machines(laboratory: Laboratory) -> list[tuple[Place, Machine]]:
    found: list[tuple[Place, Machine]] = [(("server",), laboratory.server)]
    if laboratory.tracker:
        found.append((("tracker",), laboratory.tracker))
    found += [(("robot", number), robot) for number, robot in enumerate(laboratory.robot)]
    return found


def _check_names(machine: Machine, where: Place, file: ConfigFile) -> None:
    for name, (pattern, signs) in _PATTERNS.items():
        value = getattr(machine, name)
        if not pattern.fullmatch(value) or ".." in value:
            raise file.error((*where, name), f"{name!r} is {value!r}; it may have {signs}")


def _check_robot(laboratory: Laboratory, number: int, robot: RobotMachine, file: ConfigFile) -> None:
    where = ("robot", number)
    check_robot_id(robot.id, (*where, "id"), file)
    if any(other.id == robot.id for other in laboratory.robot[:number]):
        raise file.error((*where, "id"), f"two robots are called {robot.id!r}")
    for name in ("driver", "address"):
        if not _WORD.fullmatch(getattr(robot, name)):
            text = f"{name!r} is {getattr(robot, name)!r}; it may have letters, digits, and . _ : / -"
            raise file.error((*where, name), text)
    if robot.calibration and not robot.calibration.is_file():
        raise file.error((*where, "calibration"), f"{robot.calibration}: there is no such file")


def _check_shared_machines(laboratory: Laboratory, file: ConfigFile) -> None:
    """Two entries of one machine have to mean the same place on it."""
    first: dict[tuple[str, str, int], Machine] = {}
    for where, machine in _machines(laboratory):
        other = first.setdefault(machine.login, machine)
        for name in ("python", "directory"):
            mine, theirs = getattr(machine, name), getattr(other, name)
            if mine != theirs:
                user, host, _ = machine.login
                text = f"{name!r} of {user}@{host} is {mine!r} here and {theirs!r} above: write the same"
                raise file.error((*where, name), text)
