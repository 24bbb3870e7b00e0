"""The reference of experiment and laboratory files, read off the settings' own source, table by table."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import types
import typing
from enum import Enum
from pathlib import Path
from typing import Any

from swarm.config.experiment import Experiment
from swarm.config.laboratory import Laboratory
from swarm.config.toml_files import Between

EXPERIMENT_TABLES = {"run": "[run]", "arena": "[arena]", "learning": "[learning]", "visits": "[visits]"} | {
    "camera": "[camera]",
    "body": "[body]",
    "tracker": "[tracker]",
    "simulation": "[simulation]",
    "log": "[log]",
    "robot": "[[robot]]",
}
LABORATORY_TABLES = {"laboratory": "[laboratory]", "server": "[server]", "tracker": "[tracker]"} | {
    "versions": "[versions]",
    "policies": "[policies]",
    "robot": "[[robot]]",
}


def experiment_reference() -> str:
    """All of an experiment file as Markdown."""
    return _markdown(Experiment, EXPERIMENT_TABLES)


def laboratory_reference() -> str:
    """All of a laboratory file as Markdown."""
    return _markdown(Laboratory, LABORATORY_TABLES)


def _markdown(whole: type, tables: dict[str, str]) -> str:
    hints = typing.get_type_hints(whole, include_extras=True)
    parts = []
    for name, heading in tables.items():
        kind = _not_none(typing.get_args(hints[name])[0] if name == "robot" else hints[name])
        parts.append(f"### `{heading}`\n\n{_intro(kind)}\n\n{_table(kind)}")
    return "\n\n".join(parts) + "\n"


def _intro(kind: type) -> str:
    text = inspect.cleandoc(kind.__doc__ or "")
    return text.split(": ", 1)[-1][:1].upper() + text.split(": ", 1)[-1][1:]


def _table(kind: type) -> str:
    hints = typing.get_type_hints(kind, include_extras=True)
    meanings = {name: text for base in reversed(kind.__mro__[:-1]) for name, text in _meanings(base).items()}
    rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
    for field in dataclasses.fields(kind):
        value, default = _value(hints[field.name]), _default(field)
        rows.append(f"| `{field.name}` | {value} | {default} | {meanings.get(field.name, '')} |")
    return "\n".join(rows)


def _meanings(kind: type) -> dict[str, str]:
    """The texts that stand under the fields in the source."""
    definition = ast.parse(inspect.getsource(kind)).body[0]
    assert isinstance(definition, ast.ClassDef)
    found = {}
    for field, text in zip(definition.body, definition.body[1:], strict=False):
        is_text = isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and is_text:
            found[field.target.id] = " ".join(str(text.value.value).split())  # type: ignore[attr-defined]
    return found


def _not_none(hint: Any) -> Any:
    """The type of a setting that may be left out."""
    choices = [choice for choice in typing.get_args(hint) if choice is not type(None)]
    return choices[0] if isinstance(hint, types.UnionType) else hint


def _value(hint: Any) -> str:
    hint = _not_none(hint)
    if typing.get_origin(hint) is typing.Annotated:
        kind, bounds = typing.get_args(hint)
        return f"{_value(kind)}, {_range(bounds)}" if isinstance(bounds, Between) else _value(kind)
    if typing.get_origin(hint) is tuple:
        kinds = typing.get_args(hint)
        return (
            f"list of {_value(kinds[0])}" if kinds[-1] is Ellipsis else f"[{', '.join(map(_value, kinds))}]"
        )
    if issubclass(hint, Enum):
        return " or ".join(f'`"{member.value}"`' for member in hint)
    return {str: "text", int: "whole number", float: "number", bool: "true or false", Path: "a file's path"}[
        hint
    ]


_WORDS = {str: "text", int: "whole number", float: "number", bool: "true or false", Path: "a file's path"}


def _range(bounds: Between) -> str:
    if bounds.high == float("inf"):
        return f"at least {bounds.low:g}"
    return f"{bounds.low:g} to {bounds.high:g}"


def _default(field: dataclasses.Field[Any]) -> str:
    if field.default is dataclasses.MISSING:
        return "required"
    if field.default is None:
        return "none"
    value = field.default.value if isinstance(field.default, Enum) else field.default
    return f"`{list(value) if isinstance(value, tuple) else value!r}`".replace("'", '"')
