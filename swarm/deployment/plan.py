"""What a machine is to run, and what of it is not there yet."""

from __future__ import annotations

import asyncio
import re
from base64 import b64decode, b64encode
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from swarm.config.laboratory import Laboratory
from swarm.deployment.fleet import Target
from swarm.deployment.link import MachineError
from swarm.deployment.release import ID_DIGITS, ExperimentFiles, Files, Protection, release_files, release_id
from swarm.deployment.wheels import Platform, Wheelhouse, digest_of, requirements

OLDEST_PYTHON = (3, 11)
"""As in pyproject.toml."""
SAFE_ROOT = re.compile(r"/[A-Za-z0-9._/-]+")
"""What may stand in a unit: nothing that systemd or a shell reads as its own."""
UNPACKED = 5
"""Times the size of the wheels that a program takes with them (measured: 3.9 for a board's)."""


@dataclass(frozen=True)
class Wheels:
    """What a program is made of on one machine."""

    program: Path
    libraries: list[Path]
    installer: Path
    """pip's; it is copied, not installed."""
    system_packages: bool
    """Whether the program uses what the machine's system has."""

    @property
    def by_place(self) -> dict[str, Path]:
        """Each by its place below a machine's folder of wheels."""
        return {_place(file): file for file in (*self.libraries, self.program, self.installer)}

    def request(self) -> dict[str, Any]:
        """What a machine is told of them."""
        return {
            "build": digest_of(self.program)[:ID_DIGITS],
            "wheels": [_place(file) for file in (*self.libraries, self.program)],
            "installer": _place(self.installer),
            "system_packages": self.system_packages,
        }


def _place(wheel: Path) -> str:
    return f"{digest_of(wheel)}/{wheel.name}"


@dataclass(frozen=True)
class Plan:
    """A release for one machine."""

    release: str
    program: str
    extras: list[str]
    """Of the package, that the machine needs."""
    wheels: Wheels
    files: Files
    experiment: list[str]
    """Which of the files are the experiment's."""
    services: list[str]
    missing: Mapping[str, Path]
    """Wheels that are not on the machine yet, by their place there."""
    changes: list[str]
    """What differs from what runs there: `program`, services, names of files."""

    @property
    def request(self) -> dict[str, Any]:
        """What the machine is asked to install."""
        return {
            "release": self.release,
            "program": self.program,
            "experiment": self.experiment,
            "extras": self.extras,
            "starts": self.services,
            "files": {name: b64encode(content).decode() for name, content in self.files.items()},
            **self.wheels.request(),
        }


class Planner:
    """Plans for machines; with `run` the experiment is to begin at once.

    Wheels are fetched for one machine at a time: the next of its kind finds them.
    """

    def __init__(
        self,
        laboratory: Laboratory,
        wheelhouse: Wheelhouse,
        version: str,
        experiment: ExperimentFiles | None,
        protection: Protection,
        *,
        run: bool,
    ) -> None:
        self._laboratory = laboratory
        self._wheelhouse = wheelhouse
        self._version = version
        self._experiment = experiment
        self._protection = protection
        self._run = run
        self._one_at_a_time = asyncio.Lock()

    async def plan(self, target: Target, found: Mapping[str, Any]) -> Plan:
        """What a machine is to run, given what it says of itself; MachineError if it cannot."""
        _check(found)
        extras = self._extras(target, found["about"])
        async with self._one_at_a_time:
            wheels = await asyncio.to_thread(self._wheels, target, extras, found)
        about, places = found["about"], wheels.by_place
        missing = {place: file for place, file in places.items() if place not in found["wheels"]}
        _check_room(found, missing.values())
        experiment = self._experiment_files(found)
        files = release_files(target, self._laboratory, self._protection, found["root"], experiment)
        services = self._services(target, about)
        program = _digest(found["python"], str(wheels.system_packages), *sorted(places))
        return Plan(
            release_id(program, files, services),
            program,
            sorted(extras),
            wheels,
            files,
            sorted(experiment),
            services,
            missing,
            _changes(program, files, services, about),
        )

    def _extras(self, target: Target, about: Mapping[str, Any]) -> frozenset[str]:
        """Of the experiment, or what the one that is kept there needed."""
        if self._experiment:
            return target.extras(self._experiment.experiment)
        return target.extras(None) | set(about.get("extras", ()))

    def _wheels(self, target: Target, extras: frozenset[str], found: Mapping[str, Any]) -> Wheels:
        """The server has more than the system's packages are tried with: it gets its own."""
        program = self._wheelhouse.program(self._version)
        supplied = {} if target.conducts else found["packages"]
        needed, system_packages = requirements(program, extras, supplied)
        libraries = self._wheelhouse.libraries(needed, Platform.of(found))
        return Wheels(program, libraries, self._wheelhouse.installer(), system_packages)

    def _experiment_files(self, found: Mapping[str, Any]) -> Files:
        if self._experiment:
            return self._experiment.files
        return {name: b64decode(content) for name, content in found["experiment"].items()}

    def _services(self, target: Target, about: Mapping[str, Any]) -> list[str]:
        """Of the experiment, or of what runs there now what still belongs there."""
        if self._experiment:
            robots = [robot.id for robot in self._experiment.experiment.robot]
            return target.services(robots, self._run)
        everything = target.services([robot.id for robot in target.robots], run=True)
        return [name for name in everything if name in about["services"]]


def _check(found: Mapping[str, Any]) -> None:
    if tuple(map(int, found["python"].split(".")[:2])) < OLDEST_PYTHON:
        raise MachineError(f"its Python is {found['python']}, and 3.11 is needed: name another in `python`")
    if not SAFE_ROOT.fullmatch(found["root"]):
        raise MachineError(f"its directory is {found['root']!r}: name another in `directory`")


def _check_room(found: Mapping[str, Any], wheels: Iterable[Path]) -> None:
    needed = UNPACKED * sum(file.stat().st_size for file in wheels)
    if found["free_bytes"] < needed:
        free_mb, needed_mb = found["free_bytes"] / 1e6, needed / 1e6
        raise MachineError(f"its disk has {free_mb:,.0f} MB free and {needed_mb:,.0f} MB are needed")


def _changes(program: str, files: Files, services: list[str], about: Mapping[str, Any]) -> list[str]:
    before = about.get("files", {})
    changed = [] if about.get("virtual_environment") == program else ["program"]
    changed += [name for name, content in files.items() if before.get(name) != sha256(content).hexdigest()]
    changed += [name for name in before if name not in files]
    return sorted(changed) + [name for name in services if name not in about["services"]]


def _digest(*words: str) -> str:
    return sha256("\n".join(words).encode()).hexdigest()[:ID_DIGITS]
