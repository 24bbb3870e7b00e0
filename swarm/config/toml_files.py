"""TOML files to typed settings: whatever a file says that the settings do not know stops the program.

An error names the file, the line, what is allowed and the nearest known key.
"""

from __future__ import annotations

import dataclasses
import math
import re
import tomllib
import types
import typing
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

from swarm.config.changes import Change, Where
from swarm.errors import UserError, nearest, one_line

S = TypeVar("S")


@dataclass(frozen=True)
class Between:
    """The range that a number may have, borders included; use with `Annotated`."""

    low: float
    high: float = math.inf


class ConfigFile:
    """A TOML file with the places of its keys, for errors that a person can follow.

    `text` is what it says, if that stands somewhere else than in a file; `changes` are what a command line
    says in place of some of its values.
    """

    def __init__(self, path: Path, text: str | None = None, changes: Iterable[Change] = ()) -> None:
        self.path = path
        self._lines = (_read(path) if text is None else text).splitlines()
        try:
            self.values: dict[str, Any] = tomllib.loads("\n".join(self._lines))
        except ValueError as error:
            raise UserError(f"{path}: not valid TOML: {one_line(str(error), LONGEST_ERROR)}") from error
        except RecursionError as error:
            raise UserError(f"{path}: not valid TOML: brackets in brackets, too deep to read") from error
        self._options: dict[Where, str] = {}
        for change in changes:
            self._apply(change)

    def _apply(self, change: Change) -> None:
        """An option answers for its key, and for a table that the file does not have."""
        known = set(self.values)
        where = change.apply(self.values)
        self._options[where] = change.option
        if where[0] not in known:
            self._options[where[:1]] = change.option

    def error(self, where: Where, text: str) -> UserError:
        """An error about the key at a place such as ("robot", 1, "id")."""
        return UserError(f"{self.place(where)}: {one_line(text, LONGEST_ERROR)}")

    def place(self, where: Where) -> str:
        """File and line of the key at a place, or the option that gave its value.

        With a key of the file all options are named: it may be right but for one of them.
        """
        for changed, option in self._options.items():
            if where[: len(changed)] == changed:
                return option
        others = ", ".join(dict.fromkeys(self._options.values()))
        return f"{self.path}:{self._line_of(where)}{f' with {others}' if others else ''}"

    def settings(self, kind: type[S]) -> S:
        """The whole file as one settings dataclass."""
        return self._table(kind, self.values, ())

    def _table(self, kind: type[S], values: dict[str, Any], where: Where) -> S:
        fields = {field.name: field for field in dataclasses.fields(kind)}  # type: ignore[arg-type]
        hints = typing.get_type_hints(kind, include_extras=True)
        for name in values:
            if name not in fields:
                raise self.error((*where, name), f"unknown key {name!r}; {nearest(name, fields)}")
        for name, field in fields.items():
            if name not in values and _is_required(field):
                raise self.error(where, f"{name!r} is missing{_in_table(where)}")
        return kind(
            **{name: self._value(hints[name], value, (*where, name)) for name, value in values.items()}
        )

    def _value(self, hint: Any, value: Any, where: Where) -> Any:
        bounds: Between | None = None
        if typing.get_origin(hint) is typing.Annotated:
            hint, bounds = typing.get_args(hint)
        if isinstance(hint, types.UnionType):
            hint = next(choice for choice in typing.get_args(hint) if choice is not type(None))
        if dataclasses.is_dataclass(hint) and isinstance(hint, type):
            if not isinstance(value, dict):
                raise self.error(where, f"{_name(where)!r} is a table, not {_shown(value)}")
            return self._table(hint, value, where)
        if typing.get_origin(hint) is tuple:
            return self._sequence(hint, bounds, value, where)
        return self._scalar(hint, bounds, value, where)

    def _sequence(self, hint: Any, bounds: Between | None, value: Any, where: Where) -> Any:
        kinds = typing.get_args(hint)
        if not isinstance(value, list):
            raise self.error(where, _no_list(where, kinds[0], value))
        if kinds[-1] is Ellipsis:
            kinds = (kinds[0],) * len(value)
        if len(kinds) != len(value):
            raise self.error(where, f"{where[-1]!r} has {len(value)} values; it takes {len(kinds)}")
        hints = [typing.Annotated[kind, bounds] if bounds else kind for kind in kinds]
        return tuple(
            self._value(kind, entry, (*where, i))
            for i, (kind, entry) in enumerate(zip(hints, value, strict=True))
        )

    def _scalar(self, kind: type, bounds: Between | None, value: Any, where: Where) -> Any:
        name = _name(where)
        if kind is Path:
            return self._beside(value, where)
        if issubclass(kind, Enum):
            known = {member.value: member for member in kind}
            if not isinstance(value, str) or value not in known:
                raise self.error(where, f"{name!r} is {_shown(value)}; {nearest(str(value), known)}")
            return known[value]
        if kind is float and type(value) is int and abs(value) <= LARGEST_WHOLE:
            value = float(value)
        if type(value) is not kind:
            raise self.error(where, f"{name!r} is a {_WORDS[kind]}, not {_shown(value)}")
        if isinstance(value, int | float) and not isinstance(value, bool):
            self._check_number(name, value, bounds, where)
        return value

    def _beside(self, value: Any, where: Where) -> Path:
        """A file that is named in this one: its path starts at this one's folder."""
        name: str = self._scalar(str, None, value, where)
        if not name or "\0" in name:
            raise self.error(where, f"{_name(where)!r} is {_shown(value)}, which names no file")
        return self.path.parent / name

    def _check_number(self, name: str, value: float, bounds: Between | None, where: Where) -> None:
        if isinstance(value, float) and not math.isfinite(value):
            raise self.error(where, f"{name!r} is {value}; a finite number is wanted")
        if bounds and not bounds.low <= value <= bounds.high:
            at_most = "" if math.isinf(bounds.high) else f" and at most {bounds.high:g}"
            raise self.error(
                where, f"{name!r} is {_shown(value)}; it has to be at least {bounds.low:g}{at_most}"
            )

    def _line_of(self, where: Where) -> int:
        """The line of a key, or of the table that it belongs to, counted from 1."""
        names = [part for part in where if isinstance(part, str)]
        counts = [part for part in where if isinstance(part, int)]
        best, table, seen = 1, "", 0
        wanted_table = ".".join(names[:-1])
        for number, line in enumerate(self._lines, 1):
            header = re.match(r"\s*\[\[?\s*([\w.\- ]+?)\s*\]\]?", line)
            if header:
                seen = seen + 1 if header[1] == table else 0
                table = header[1]
                is_right = table in (wanted_table, ".".join(names)) and (not counts or seen == counts[0])
                best = number if is_right else best
            elif names and table == wanted_table and (not counts or seen == counts[0] or not table):
                key = re.match(r"""\s*["']?([\w\-]+)["']?\s*=""", line)
                if key and key[1] == names[-1]:
                    return number
        return best


_WORDS = {str: "text", int: "whole number", float: "number", bool: "true or false"}


LARGEST_WHOLE = 2**53
"""Up to here every whole number is a number (IEEE 754), and no setting is larger."""
LONGEST_ERROR = 400
"""Characters that an error says beside its place."""
LONGEST_SHOWN = 60
"""Characters of a value in an error, which is to stay one line that can be read."""


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def _name(where: Where) -> str:
    """The name of the key, also of an entry of a list."""
    return next(str(part) for part in reversed(where) if isinstance(part, str))


def _no_list(where: Where, kind: Any, value: Any) -> str:
    """What a list of this kind looks like, for somebody who wrote no list."""
    name = _name(where)
    if dataclasses.is_dataclass(kind):
        return f"there may be several: write [[{name}]], with two brackets, above each"
    if isinstance(where[-1], int):
        return f"{name!r} is a list of lists, such as [[{_shown(value)}]]; {_shown(value)} is no list"
    return f"{name!r} is a list, not {_shown(value)}"


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise UserError(f"{path}: there is no such file") from error
    except OSError as error:
        raise UserError(f"{path}: cannot be read as text ({error.strerror})") from error
    except ValueError as error:
        raise UserError(f"{path}: cannot be read as text ({one_line(str(error), LONGEST_ERROR)})") from error


def _is_required(field: dataclasses.Field[Any]) -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _in_table(where: Where) -> str:
    names = ".".join(str(part) for part in where if isinstance(part, str))
    return f" in [{names}]" if names else ""
