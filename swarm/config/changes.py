"""`--set TABLE.KEY=VALUE`: a value that the command line says in place of an experiment file's."""

from __future__ import annotations

import argparse
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from swarm.errors import UserError, nearest

SET_HELP = "TABLE.KEY=VALUE or robot.ID.KEY=VALUE in place of the file's, such as learning.epsilon=0.3"
ROBOT = "robot"
"""The one table of which there are several: a robot's is named by its id."""

Where = tuple[str | int, ...]
"""A key's place in a file, such as ("robot", 1, "watches")."""


@dataclass(frozen=True)
class Change:
    """One `--set`, checked for its form alone; what may stand there is the settings' business."""

    text: str
    names: tuple[str, ...]
    value: Any

    @property
    def option(self) -> str:
        """As a person wrote it."""
        return f"--set {self.text}"

    @classmethod
    def parse(cls, text: str) -> Change:
        """UserError for what names no key, or no value."""
        key, equals, value = text.partition("=")
        names = tuple(key.strip().split("."))
        wanted = 3 if names[0] == ROBOT else 2
        if not equals or len(names) != wanted or not all(names):
            raise UserError(f"--set {text}: say {SET_HELP}")
        return cls(text, names, toml_value(value))

    def apply(self, values: dict[str, Any]) -> Where:
        """Put the value into a file's values, and say where it stands now; UserError for an unknown robot."""
        *tables, key = self.where(values)
        table: Any = values
        for name in tables:
            table = table[name] if isinstance(name, int) else table.setdefault(name, {})
        if not isinstance(table, dict):
            raise UserError(f"{self.option}: {self.names[0]!r} is no table of an experiment file")
        table[key] = self.value
        return (*tables, key)

    def where(self, values: Mapping[str, Any]) -> Where:
        """A robot by its number among those of the file."""
        if self.names[0] != ROBOT:
            return self.names
        _, robot, key = self.names
        tables = values.get(ROBOT)
        entries = [entry for entry in tables if isinstance(entry, dict)] if isinstance(tables, list) else []
        ids = [str(entry.get("id")) for entry in entries]
        if robot not in ids:
            raise UserError(f"{self.option}: no robot is called {robot!r}; {nearest(robot, ids)}")
        return ROBOT, ids.index(robot), key


def changes_of(texts: Iterable[str] | None) -> list[Change]:
    """Those of a command line, in its order."""
    return [Change.parse(text) for text in texts or ()]


def toml_value(text: str) -> Any:
    """A value as in a TOML file; words may stand without quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        return text


def add_set_option(parser: argparse.ArgumentParser) -> None:
    """For a command that takes an experiment file."""
    parser.add_argument("--set", action="append", metavar="TABLE.KEY=VALUE", help=SET_HELP)
