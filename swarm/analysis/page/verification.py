"""Are the numbers of a page those of its logs? All are made once more, and those that differ are named."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from swarm.analysis.page.document import page_text, read_page
from swarm.errors import UserError
from swarm.files import printable

Place = tuple[str | int, ...]


@dataclass(frozen=True)
class Difference:
    """A number, or a text beside it, that is not what the logs say."""

    name: str
    in_page: Any
    in_logs: Any

    def __str__(self) -> str:
        return f"{self.name}: the page says {_shown(self.in_page)}, the logs say {_shown(self.in_logs)}"


@dataclass(frozen=True)
class Verification:
    """What was found of a page."""

    page: Path
    numbers: int
    """That were compared."""
    differences: Sequence[Difference]
    own_script: bool
    """Whether the page shows its data by this version's script, and nothing else."""

    def as_json(self) -> dict[str, Any]:
        return {
            "page": printable(self.page),
            "same": not self.differences,
            "numbers": self.numbers,
            "own_script": self.own_script,
            "differences": [vars(found) for found in self.differences],
        }


def compared(page: Path, contents: Mapping[str, Any], again: Mapping[str, Any]) -> Verification:
    """A page's contents beside those made once more from its logs."""
    found = [
        Difference(_name(place, again), ours, theirs)
        for place, ours, theirs in _differences(dict(contents), dict(again), ())
    ]
    own = page.read_text(encoding="utf-8") == page_text(dict(contents))
    return Verification(page, sum(_numbers(again)), found, own)


def runs_of(page: Path, runs: Sequence[Path]) -> tuple[dict[str, Any], list[Path]]:
    """A page's contents and the runs that it was made of: where they lay from the page, or those given."""
    contents = read_page(page)
    try:
        named = [str(run) for run in contents["runs"]]
        int(contents["threshold"])
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{printable(page)}: does not say which runs it was made of") from error
    places = list(runs) or [page.parent / name for name in named]
    for place in places:
        if not place.exists():
            raise UserError(
                f"{printable(place)}: the page was made of it, and it is not there; say where its runs are: "
                f"swarm verify {printable(page)} RUN..."
            )
    return contents, places


def _differences(ours: Any, theirs: Any, place: Place) -> Iterator[tuple[Place, Any, Any]]:
    if isinstance(ours, dict) and isinstance(theirs, dict):
        for key in [*theirs, *(key for key in ours if key not in theirs)]:
            if place or key != "runs":
                yield from _differences(ours.get(key), theirs.get(key), (*place, key))
    elif isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        for number, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            yield from _differences(one, other, (*place, number))
    elif ours != theirs or type(ours) is not type(theirs):
        yield place, ours, theirs


def _numbers(contents: Any) -> Iterator[bool]:
    """True for each number."""
    if isinstance(contents, dict | list):
        for inner in contents.values() if isinstance(contents, dict) else contents:
            yield from _numbers(inner)
    else:
        yield isinstance(contents, int | float) and not isinstance(contents, bool)


def _name(place: Place, contents: Mapping[str, Any]) -> str:
    """The words of whoever reads the page."""
    kind, rest = place[0], place[1:]
    if kind == "tables" and len(rest) >= 4:
        return _name_in_table(contents["tables"][rest[0]], rest)
    if kind == "curves" and len(rest) >= 2:
        return _name_in_curve(contents["curves"][rest[0]], rest[1:])
    if kind == "learning" and len(rest) >= 2:
        return _name_in_learning(contents["learning"][rest[0]], rest[1:])
    if kind == "logs" and len(rest) >= 2:
        return f"log {contents['logs'][rest[0]]['name']}, {rest[1]}"
    return ", ".join(map(str, place))


def _name_in_table(table: Mapping[str, Any], place: Place) -> str:
    """ "Learning, imitation, path at the end"."""
    _, _, row, column, *inner = place
    assert isinstance(row, int)
    assert isinstance(column, int)
    cells = table["rows"][row]
    text = next((cell for cell in cells if isinstance(cell, str)), "")
    beside = [name for name in inner if name in ("text", "source")]
    words = [table["title"], _row_name(table, row, text), table["head"][column] or "value", *map(str, beside)]
    return ", ".join(word for word in words if word)


def _row_name(table: Mapping[str, Any], row: int, text: str) -> str:
    """Rows that begin alike are told apart by their numbers."""
    alike = sum(cells[0] == text for cells in table["rows"])
    return text if alike == 1 else f"{text} (row {row + 1})"


def _name_in_curve(curve: Mapping[str, Any], place: Place) -> str:
    what, *inner = place
    name = f"curve of {curve['name']}"
    if what in ("moves", "mean", "low", "high") and inner:
        return f"{name}, {what} at move {curve['moves'][inner[0]]}"
    if what == "trials" and len(inner) == 3 and inner[1] == "lengths":
        seed, trial = curve["trials"][inner[0]]["of"]
        return f"{name}, trial {trial} of seed {seed} at move {curve['moves'][inner[2]]}"
    return ", ".join(map(str, (name, what, *inner)))


def _name_in_learning(learning: Mapping[str, Any], place: Place) -> str:
    what, *inner = place
    name = f"{learning['robot']} in trial {learning['trial']} of seed {learning['seed']}"
    if inner and isinstance(learning.get(str(what)), list) and len(inner) == 1 and what != "remembered":
        return f"{name}, {what} of move {learning['number'][inner[0]]}"
    return ", ".join(map(str, (name, what, *inner)))


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
