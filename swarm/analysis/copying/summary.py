"""What runs show of copying: which paths were enacted, copying errors by kind, visits that taught nothing."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from swarm.analysis.copying.errors import ErrorKind
from swarm.analysis.copying.paths import LoggedPath, Seen, read_paths, seen_positions

SHOWN = 4
"""So many fit beside each other on a page."""


@dataclass(frozen=True)
class Copying:
    """Everything about copying in some runs; `failures` counts the reasons of visits that taught nothing."""

    paths: Sequence[LoggedPath]
    replays: pl.DataFrame
    visits: int
    failures: Mapping[str, int]
    seen: Mapping[LoggedPath, Seen]
    """Where the observer believed that the demonstrator was, for the copies of `chosen_copies`."""

    def __bool__(self) -> bool:
        """Whether there is anything to say."""
        return bool(self.paths or self.visits)

    @property
    def enacted(self) -> list[LoggedPath]:
        """From the most to the least enacted; of equals, the higher R first."""
        return sorted(self.paths, key=lambda path: (-path.replays, -path.ratio))

    @property
    def miscopied(self) -> list[LoggedPath]:
        """From the most to the least enacted."""
        return [path for path in self.enacted if path.error not in (None, ErrorKind.PERFECT)]

    @property
    def perfect(self) -> list[LoggedPath]:
        return [path for path in self.enacted if path.error is ErrorKind.PERFECT]

    def errors(self) -> dict[ErrorKind, int]:
        """How many copies there are of every kind of error, also of kinds that do not occur."""
        counts = Counter(path.error for path in self.paths)
        return {kind: counts[kind] for kind in ErrorKind}

    def as_json(self) -> dict[str, Any]:
        invented = [path for path in self.miscopied if not path.really_made]
        return {
            "visits": self.visits,
            "failed_visits": dict(self.failures),
            "paths": len(self.paths),
            "errors": {str(kind): count for kind, count in self.errors().items()},
            "perfect": reinforcement(self.perfect),
            "miscopied": reinforcement(self.miscopied),
            "miscopied_and_never_made": reinforcement(invented),
            "miscopied_paths": [_brief(path) for path in self.miscopied],
            "most_enacted": [_brief(path) for path in most_enacted(self)],
            "least_enacted": [_brief(path) for path in least_enacted(self)],
        }


def most_enacted(copying: Copying) -> list[LoggedPath]:
    """Figure 27: from the most enacted on, at most half of all paths."""
    return copying.enacted[: min(SHOWN, (len(copying.paths) + 1) // 2)]


def least_enacted(copying: Copying) -> list[LoggedPath]:
    """Figure 28: from the least enacted on, at most half of all paths (a single path is both)."""
    return copying.enacted[::-1][: min(SHOWN, max(1, len(copying.paths) // 2))]


def chosen_copies(paths: Sequence[LoggedPath]) -> list[LoggedPath]:
    """Figure 29: of paths in the order of enactment, the two most enacted copies, then the two worst."""
    judged = [path for path in paths if path.error]
    wrong = [path for path in judged[SHOWN // 2 :] if path.edit_distance]
    worst = sorted(wrong, key=lambda path: -(path.edit_distance or 0))
    return judged[: SHOWN // 2] + worst[: SHOWN // 2]


def reinforcement(paths: Sequence[LoggedPath]) -> dict[str, Any]:
    """What learning made of some paths: how often they were replayed, and their R at the end."""
    ratios = [path.ratio for path in paths]
    return {
        "paths": len(paths),
        "replays": sum(path.replays for path in paths),
        "mean_ratio": sum(ratios) / len(ratios) if ratios else None,
        "highest_ratio": max(ratios, default=None),
    }


def read_copying(tables: Mapping[str, Path], cells_m: Mapping[str, float]) -> Copying:
    """Put the tables together; `cells_m`: the side of a cell in each log."""
    paths = read_paths(tables)
    visits, failures = _visits(tables)
    found = Copying(paths, pl.read_parquet(tables["replays"], glob=False), visits, failures, {})
    chosen = chosen_copies(found.enacted)
    seen = {path: seen_positions(tables, path, cells_m[path.log]) for path in chosen}
    return Copying(paths, found.replays, visits, failures, seen)


def reason_kind(reason: str) -> str:
    """A reason with its numbers replaced, so that equal reasons can be counted."""
    return re.sub(r"\d+(\.\d+)?", "n", reason)


def _visits(tables: Mapping[str, Path]) -> tuple[int, dict[str, int]]:
    """How many visits ended, and why some taught nothing."""
    if "visits" not in tables:
        return 0, {}
    done = pl.read_parquet(tables["visits"], glob=False).filter(pl.col("done_t_s").is_not_null())
    vain = Counter(map(reason_kind, done.filter(path=0)["reason"].to_list()))
    return done.height, dict(sorted(vain.items(), key=lambda item: (-item[1], item[0])))


def _brief(path: LoggedPath) -> dict[str, Any]:
    names = ("condition", "robot", "seed", "trial", "path", "source", "replays", "known_for", "ratio")
    error = {"error": path.error and str(path.error), "edit_distance": path.edit_distance}
    return {name: getattr(path, name) for name in names} | {"moves": list(path.moves)} | error
