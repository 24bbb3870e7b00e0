"""The wheels that a machine is given: built or fetched once for each kind of machine, and kept."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from email.parser import HeaderParser
from hashlib import sha256
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from packaging.requirements import Requirement
from packaging.version import Version

import swarm
from swarm.errors import UserError
from swarm.version import DISTRIBUTION

SYSTEM_PACKAGES = {
    "numpy": "numpy",
    "opencv-python-headless": "cv2",
    "pyserial": "serial",
    "smbus2": "smbus2",
    "spidev": "spidev",
}
"""What Debian has for boards, by the name that pip knows and the name that Python imports. Its protobuf is
too old, and it has no zenoh."""
OLDEST_GLIBC = 17
"""2.17, that of manylinux2014: what older machines have, Python 3.11 has no wheels for."""
BEGINNING_OF_ZIP = "315532800"
"""1980, where a zip's times begin: a wheel that is built twice from one source has the same bytes."""
OLDEST_SETUPTOOLS = Version("77")
"""As in pyproject.toml."""
NOT_BUILT_IN = shutil.ignore_patterns(
    ".*", "build", "dist", "runs", "site", "docs", "tests", "__pycache__", "*.egg-info", "wheelhouse"
)


@dataclass(frozen=True)
class Platform:
    """For which Python, on which machine, with which C library a wheel has to be."""

    machine: str
    python: tuple[int, int]
    glibc: tuple[int, int]

    @classmethod
    def of(cls, found: Mapping[str, Any]) -> Platform:
        """That of a machine, from what it says of itself. A 64-bit kernel may carry a 32-bit Debian."""
        machine = found["machine"]
        if found["bits"] == 32:
            machine = {"aarch64": "armv7l", "armv8l": "armv7l", "x86_64": "i686"}.get(machine, machine)
        return cls(machine, _two(found["python"]), _two(found["libc"] or "2.17"))

    def __str__(self) -> str:
        return f"{self.machine}, Python {self.python[0]}.{self.python[1]}"

    @property
    def folder(self) -> str:
        """A name for the wheels of this kind."""
        major, minor = self.python
        return f"cp{major}{minor}-{self.machine}-glibc{self.glibc[0]}.{self.glibc[1]}"

    @property
    def options(self) -> list[str]:
        """What pip has to be told to find them."""
        major, minor = self.python
        tags = [f"manylinux_2_{n}_{self.machine}" for n in range(self.glibc[1], OLDEST_GLIBC - 1, -1)]
        tags += [f"manylinux2014_{self.machine}", f"linux_{self.machine}"]
        tags += ["linux_armv6l"] if self.machine == "armv7l" else []
        words = ["--only-binary=:all:", "--implementation=cp", f"--python-version={major}.{minor}"]
        words += [f"--abi={abi}" for abi in (f"cp{major}{minor}", "abi3", "none")]
        return words + [f"--platform={tag}" for tag in tags]


def _two(version: str) -> tuple[int, int]:
    major, minor = version.split(".")[:2]
    return int(major), int(minor)


class Wheelhouse:
    """A folder of wheels, one below it for each kind of machine; what is there is not fetched again."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory

    def program(self, version: str) -> Path:
        """The wheel of this package: one of that version that lies in the folder, or one built from here."""
        given = sorted(self._directory.glob(f"swarm_runtime-{version}-*.whl"))
        return given[-1] if given else self._built(version)

    def installer(self) -> Path:
        """pip, for machines that have none."""
        place = self._directory / "installer"
        here = sorted(place.glob("pip-*.whl"))
        return here[-1] if here else self._fetch(["pip"], [], place)[0]

    def libraries(self, needed: Iterable[str], platform: Platform) -> list[Path]:
        """The wheels of these requirements, and of what they need in turn."""
        wanted = sorted(needed)
        return self._fetch(wanted, platform.options, self._directory / platform.folder) if wanted else []

    def _fetch(self, wanted: list[str], options: list[str], store: Path) -> list[Path]:
        """Without the network if the store has them all."""
        store.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory() as folder:
            words = ["download", "--dest", folder, *options, "--find-links", str(store)]
            if _pip([*words, "--no-index", *wanted]):
                reason = _pip([*words, *wanted])
                if reason:
                    raise UserError(f"no wheels of {', '.join(wanted)} for {store.name}: {reason}")
            found = sorted(Path(folder).glob("*.whl"))
            return [Path(shutil.move(wheel, store / wheel.name)) for wheel in found]

    def _built(self, version: str) -> Path:
        source = Path(swarm.__file__).parent.parent
        if not (source / "pyproject.toml").exists() or version != metadata.version(DISTRIBUTION):
            raise UserError(
                f"{self._directory}: there is no wheel of {DISTRIBUTION} {version}, and this is no checkout "
                "that it could be built from: put the wheel there"
            )
        with TemporaryDirectory() as folder:
            copy = shutil.copytree(source, Path(folder) / "source", ignore=NOT_BUILT_IN)
            place = self._directory / "built" / _digest_of_tree(copy)
            reason = "" if place.exists() else _built(copy, place)
        found = sorted(place.glob(f"swarm_runtime-{version}-*.whl"))
        if not found:
            raise UserError(f"no wheel of swarm-runtime {version} could be built from {source}: {reason}")
        return found[-1]


def _digest_of_tree(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    told = "".join(f"{path.relative_to(folder)} {digest_of(path)}\n" for path in files)
    return sha256(told.encode()).hexdigest()[:12]


def _built(source: Path, place: Path) -> str:
    """Empty if the wheel was built, else why not. What builds it is fetched, if it is not here."""
    here = metadata.version("setuptools") if find_spec("setuptools") else "0"
    isolation = ["--no-build-isolation"] if Version(here) >= OLDEST_SETUPTOOLS else []
    return _pip(["wheel", "--no-deps", *isolation, "--wheel-dir", str(place), str(source)])


def requirements(wheel: Path, extras: Collection[str], supplied: Mapping[str, str]) -> tuple[list[str], bool]:
    """What a wheel needs with some extras less what a system supplies, and whether it supplies any."""
    needed, is_supplied = [], False
    for requirement in _required(wheel, extras):
        version = supplied.get(requirement.name, "")
        if version and requirement.specifier.contains(version, prereleases=True):
            is_supplied = True
        else:
            needed.append(f"{requirement.name}{_bracketed(requirement.extras)}{requirement.specifier}")
    return needed, is_supplied


def _required(wheel: Path, extras: Collection[str]) -> list[Requirement]:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        lines = HeaderParser().parsestr(archive.read(name).decode()).get_all("Requires-Dist", [])
    everything = [Requirement(line) for line in lines]
    chosen = _chosen(everything, extras)
    more = {
        extra for requirement in chosen if requirement.name == DISTRIBUTION for extra in requirement.extras
    }
    if not more <= set(extras):
        chosen = _chosen(everything, {*extras, *more})
    return [requirement for requirement in chosen if requirement.name != DISTRIBUTION]


def _chosen(everything: Iterable[Requirement], extras: Collection[str]) -> list[Requirement]:
    surroundings = [{"extra": extra} for extra in ("", *extras)]
    return [
        requirement
        for requirement in everything
        if requirement.marker is None or any(map(requirement.marker.evaluate, surroundings))
    ]


def _bracketed(extras: Collection[str]) -> str:
    return f"[{','.join(sorted(extras))}]" if extras else ""


def digest_of(file: Path) -> str:
    """Of its bytes: two wheels of one name are told apart."""
    return sha256(file.read_bytes()).hexdigest()


def _pip(words: list[str]) -> str:
    """Empty if all went well, else why not."""
    if not find_spec("pip"):
        raise UserError("pip is missing here: install it with `python -m ensurepip`")
    command = [sys.executable, "-m", "pip", *words, "--quiet", "--disable-pip-version-check"]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": BEGINNING_OF_ZIP}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode == 0:
        return ""
    errors = [
        line.removeprefix("ERROR: ")
        for line in done.stderr.splitlines()
        if line.startswith(("ERROR", "error: "))
    ]
    return errors[-1] if errors else f"pip ended with exit code {done.returncode}"
