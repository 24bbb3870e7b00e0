"""Pieces of Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of texts."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)


def text_number(value: float | None, digits: int = 1) -> str:
    """A number as a person reads it; an en dash for none."""
    return "–" if value is None else f"{value:,.{digits}f}"
