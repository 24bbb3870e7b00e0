"""What a check says: that something is good, or what is wrong and the cure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from swarm.config.toml_files import ConfigFile
from swarm.errors import UserError


class Level(StrEnum):
    """How much a finding matters."""

    GOOD = "good"
    WARNING = "warning"
    """The run can start, but somebody should know."""
    BAD = "bad"
    """The run would fail, or be worth nothing."""


Key = tuple[str | int, ...]
"""A place in the experiment file, such as ("robot", 1, "skirt")."""


@dataclass(frozen=True)
class Finding:
    """One line of `swarm doctor`."""

    level: Level
    about: str
    text: str
    cure: str = ""
    key: Key = ()

    def as_json(self) -> dict[str, str]:
        """What `--json` prints of it."""
        return {"level": self.level.value, "about": self.about, "found": self.text, "cure": self.cure}

    def __str__(self) -> str:
        return f"{self.text}; {self.cure}" if self.cure else self.text


def good(about: str, text: str) -> Finding:
    """All is well."""
    return Finding(Level.GOOD, about, text)


def bad(about: str, text: str, cure: str, key: Key = ()) -> Finding:
    """Something that has to be mended first."""
    return Finding(Level.BAD, about, text, cure, key)


def warning(about: str, text: str, cure: str, key: Key = ()) -> Finding:
    """Something that somebody should know."""
    return Finding(Level.WARNING, about, text, cure, key)


def require_good(file: Path, found: Iterable[Finding]) -> None:
    """UserError about the first finding that is bad, with its line in the experiment file if it has one."""
    for finding in found:
        if finding.level is Level.BAD:
            where = ConfigFile(file).place(finding.key) if finding.key else finding.about
            raise UserError(f"{where}: {finding}")


def any_bad(found: Iterable[Finding]) -> bool:
    """Whether something has to be mended first."""
    return any(finding.level is Level.BAD for finding in found)
