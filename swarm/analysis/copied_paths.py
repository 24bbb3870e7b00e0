"""The paths that robots remembered: how often each was enacted, its R, and how well it was copied."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from swarm.learning.edit_distance import edit_distance

OF_PATH = ["log", "robot", "path"]
PERFECT = "perfect"


@dataclass(frozen=True)
class RememberedPath:
    """One path of one robot's memory. `real` and `copied` are the whole demonstration, of which `moves`
    is the stretch that was remembered; both are None for a path that was given.
    """

    condition: str
    robot: str
    trial: int
    path: int
    moves: tuple[int, ...]
    source: str
    replays: int
    ratio: float | None
    """R after the last replay; None if there was none."""
    real: tuple[int, ...] | None
    copied: tuple[int, ...] | None

    @property
    def error(self) -> str | None:
        """The kind of copying error; None for a path that was given."""
        return None if self.real is None or self.copied is None else error_kind(self.copied, self.real)


@dataclass(frozen=True)
class Copying:
    """What a run shows of copying; `failures` counts the reasons of visits that taught nothing."""

    paths: Sequence[RememberedPath]
    replays: pl.DataFrame
    failures: Mapping[str, int]
    visits: int

    @property
    def enacted(self) -> list[RememberedPath]:
        """From the most to the least enacted (figures 27 and 28)."""
        return sorted(self.paths, key=lambda path: -path.replays)

    def as_json(self) -> dict[str, Any]:
        judged = [path for path in self.paths if path.error]
        return {
            "visits": self.visits,
            "failed_visits": dict(self.failures),
            "paths": len(self.paths),
            "errors": dict(Counter(str(path.error) for path in judged)),
            "perfect": _reinforced([path for path in judged if path.error == PERFECT]),
            "miscopied": _reinforced([path for path in judged if path.error != PERFECT]),
        }


def error_kind(copied: Sequence[int], real: Sequence[int]) -> str:
    """perfect, one move extra, one move lost, one heading wrong, or several."""
    distance = edit_distance(copied, real)
    if distance > 1:
        return "several"
    kinds = {1: "one move extra", -1: "one move lost", 0: "one heading wrong"}
    return kinds[len(copied) - len(real)] if distance else PERFECT


def read_copying(tables: Mapping[str, Path]) -> Copying:
    """Put the tables of paths, replays, visits and copying errors together."""
    paths, replays = pl.read_parquet(tables["paths"]), pl.read_parquet(tables["replays"])
    visits, errors = pl.read_parquet(tables["visits"]), pl.read_parquet(tables["copy_errors"])
    counted = replays.sort("receive_t_ns").group_by(OF_PATH).agg(replays=pl.len(), ratio=pl.last("ratio"))
    judged = errors.filter(pl.col("path") > 0).select(*OF_PATH, "true_moves", "copied_moves")
    joined = (
        paths.unique(OF_PATH, keep="last", maintain_order=True)
        .join(counted, on=OF_PATH, how="left", maintain_order="left")
        .join(judged.unique(OF_PATH), on=OF_PATH, how="left", maintain_order="left")
    )
    done = visits.filter(pl.col("phase") == "DONE")
    failures = Counter(done.filter(pl.col("path") == 0)["reason"].to_list())
    return Copying([_path(row) for row in joined.iter_rows(named=True)], replays, failures, done.height)


def _path(row: Mapping[str, Any]) -> RememberedPath:
    return RememberedPath(
        row["condition"],
        row["robot"],
        row["trial"],
        row["path"],
        tuple(row["moves"]),
        row["source"],
        row["replays"] or 0,
        row["ratio"],
        None if row["true_moves"] is None else tuple(row["true_moves"]),
        None if row["copied_moves"] is None else tuple(row["copied_moves"]),
    )


def _reinforced(paths: Sequence[RememberedPath]) -> dict[str, Any]:
    """How much the learning made of some paths."""
    ratios = [path.ratio for path in paths if path.ratio is not None]
    return {
        "paths": len(paths),
        "replays": sum(path.replays for path in paths),
        "mean_ratio": sum(ratios) / len(ratios) if ratios else None,
    }
