"""What every verb prints in the end."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from swarm.checkup.finding import Finding


def print_json(result: Mapping[str, Any]) -> None:
    """The verb's result as one JSON object, the last line of stdout."""
    print(json.dumps(result, allow_nan=False), flush=True)


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table for people; a first cell that names a level is coloured by it."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(column)
    for first, *others in rows:
        table.add_row(Text(first, style=_COLOURS.get(first, "")), *map(Text, others))
    Console().print(table)


def print_findings(found: Sequence[Finding]) -> None:
    """One line each: how much it matters, what, and the cure."""
    rows = [(finding.level.value, finding.about, finding.text, finding.cure) for finding in found]
    print_table(("", "what", "found", "cure"), rows)


_COLOURS = {"good": "green", "warning": "yellow", "bad": "red"}
