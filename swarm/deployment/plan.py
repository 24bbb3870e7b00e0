"""What a machine is to run, and what of it is not there yet."""

from __future__ import annotations

import asyncio
import re
from base64 import b64decode
from collections.abc import Mapping
from dataclasses import dataclass, field
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
class Plan:
    """A release for one machine."""

    release: str
    program: str
    wheels: Mapping[str, Path]
    """DIGEST/NAME below the machine's folder of wheels, and the file here."""
    installer: str
    """Which of the wheels is pip's; it is copied, not installed."""
    system_packages: bool
    """Whether the program uses what the machine's system has."""
    files: Files
    experiment: list[str]
    """Which of the files are the experiment's."""
    services: list[str]
    missing: list[str] = field(default_factory=list)
    """Wheels that are not on the machine yet."""
    changes: list[str] = field(default_factory=list)
    """What differs from what runs there: `program`, services, names of files."""

    @property
    def request(self) -> dict[str, Any]:
        """What the machine is asked to install, but for the files' contents."""
        installed = [name for name in self.wheels if name != self.installer]
        about = {"release": self.release, "program": self.program, "installer": self.installer}
        used = {"wheels": installed, "system_packages": self.system_packages}
        return {**about, **used, "experiment": self.experiment, "starts": self.services}


class Planner:
    """Plans for machines. Wheels are fetched for one machine at a time: the next of its kind finds them."""

    def __init__(
        self,
        laboratory: Laboratory,
        wheelhouse: Wheelhouse,
        version: str,
        experiment: ExperimentFiles | None,
        protection: Protection,
    ) -> None:
        self._laboratory = laboratory
        self._wheelhouse = wheelhouse
        self._version = version
        self._experiment = experiment
        self._protection = protection
        self._one_at_a_time = asyncio.Lock()

    async def plan(self, target: Target, found: Mapping[str, Any]) -> Plan:
        """What a machine is to run, given what it says of itself; MachineError if it cannot."""
        _check(found)
        async with self._one_at_a_time:
            wheels, installer, system_packages = await asyncio.to_thread(self._wheels, target, found)
        _check_room(found, wheels)
        about = found["about"]
        experiment = self._experiment_files(found)
        files = release_files(target, self._laboratory, self._protection, found["root"], experiment)
        services = self._services(target, about)
        program = _digest(found["python"], str(system_packages), *sorted(wheels))
        return Plan(
            release_id(program, files, services),
            program,
            wheels,
            installer,
            system_packages,
            files,
            sorted(experiment),
            services,
            missing=[name for name in wheels if name not in found["wheels"]],
            changes=_changes(program, files, services, about),
        )

    def _wheels(self, target: Target, found: Mapping[str, Any]) -> tuple[dict[str, Path], str, bool]:
        """The server has more than the system's packages are tried with: it gets its own."""
        program = self._wheelhouse.program(self._version)
        supplied = {} if target.conducts else found["packages"]
        needed, system_packages = requirements(program, target.extras, supplied)
        installer = self._wheelhouse.installer()
        files = [*self._wheelhouse.libraries(needed, Platform.of(found)), program, installer]
        wheels = {f"{digest_of(file)}/{file.name}": file for file in files}
        return wheels, f"{digest_of(installer)}/{installer.name}", system_packages

    def _experiment_files(self, found: Mapping[str, Any]) -> Files:
        if self._experiment:
            return self._experiment.files
        return {name: b64decode(content) for name, content in found["experiment"].items()}

    def _services(self, target: Target, about: Mapping[str, Any]) -> list[str]:
        """Of the experiment, or of what runs there now what still belongs there."""
        if self._experiment:
            return target.services([robot.id for robot in self._experiment.experiment.robot])
        everything = target.services([robot.id for robot in target.robots])
        return [name for name in everything if name in about["services"]]


def _check(found: Mapping[str, Any]) -> None:
    if tuple(map(int, found["python"].split(".")[:2])) < OLDEST_PYTHON:
        raise MachineError(f"its Python is {found['python']}, and 3.11 is needed: name another in `python`")
    if not SAFE_ROOT.fullmatch(found["root"]):
        raise MachineError(f"its directory is {found['root']!r}: name another in `directory`")


def _check_room(found: Mapping[str, Any], wheels: Mapping[str, Path]) -> None:
    needed = UNPACKED * sum(
        file.stat().st_size for name, file in wheels.items() if name not in found["wheels"]
    )
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
