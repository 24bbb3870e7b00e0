"""What `--with NAME=VALUE` asks: a value of the experiment's [learning]."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from swarm.config.changes import toml_value
from swarm.config.experiment import LearningSettings
from swarm.errors import UserError, nearest


def changes_of(texts: Iterable[str]) -> dict[str, Any]:
    """Names and values; UserError for a name that [learning] does not have. Values are checked later."""
    known = [field.name for field in fields(LearningSettings)]
    changes = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise UserError(f"--with {text}: say it as NAME=VALUE, for instance --with beta=0.3")
        if name not in known:
            raise UserError(f"--with {text}: [learning] has no {name!r}; {nearest(name, known)}")
        changes[name] = toml_value(value)
    return changes
