"""The learning curve of each condition: best path length against moves, a row a trial.

What is independent is the trial: learners of one condition in one trial enter as their average. Where
trials differ in length, a condition's curves are cut to the shortest; that, and every other thing that
was left out, is said in `notes`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
import polars as pl

from swarm.errors import UserError
from swarm.logs.identity import LogIdentity
from swarm.logs.parquet import read_logs
from swarm.statistics.intervals import interval
from swarm.statistics.samples import Curves, FloatArray, Scale

Replicate = tuple[int, int]
"""(seed, trial)."""


@dataclass(frozen=True)
class RunCurves:
    """A `Curves` for each condition, in alphabetical order; replicates are (seed, trial)."""

    curves: dict[str, Curves]
    cap: int
    """What a greedy path that does not arrive counts as."""
    notes: list[str] = field(default_factory=list)


def run_curves(best_paths: pl.DataFrame, shortest_moves: int) -> RunCurves:
    """From the table `best_paths`, of arenas that have no path below `shortest_moves`.

    UserError if no learner has made the ten moves of a first point.
    """
    if best_paths.is_empty():
        raise UserError("no best path in these logs: a learner reports its first after ten moves")
    notes: list[str] = []
    points = _one_a_move(best_paths, notes)
    cap = _cap(best_paths, notes)
    scale = Scale(float(shortest_moves), float(cap))
    curves = {
        str(condition): _curves(str(condition), rows, scale, notes)
        for (condition,), rows in sorted(points.group_by("condition"), key=lambda item: str(item[0]))
    }
    return RunCurves(curves, cap, notes)


def read_curves(logs: Sequence[LogIdentity], folder: Path) -> RunCurves:
    """Of logs, which leave their tables in the folder."""
    tables = read_logs(logs, folder, False, lambda _: None).tables
    shortest_moves = min(log.shortest_moves for log in logs)
    return run_curves(pl.read_parquet(tables["best_paths"], glob=False), shortest_moves)


def curve_table(found: Mapping[str, Curves]) -> pl.DataFrame:
    """A row for each condition and point: `mean`, and `low` and `high` (null where trials are too few)."""
    return pl.concat(pl.DataFrame(_columns(curves)) for curves in found.values())


def trial_table(found: RunCurves) -> pl.DataFrame:
    """A row for each condition, trial and point: the curves themselves, before any averaging."""
    frames = []
    for curves in found.curves.values():
        for replicate, values in zip(curves.replicates, curves.values, strict=True):
            seed, trial = cast(Replicate, replicate)
            place = {"condition": curves.name, "seed": seed, "trial": trial}
            frames.append(pl.DataFrame({**place, "move": _moves(curves), "best_path_length": values}))
    return pl.concat(frames)


def _columns(curves: Curves) -> dict[str, Any]:
    band = interval(curves)
    unknown = pl.repeat(None, len(curves.times), dtype=pl.Float64, eager=True)
    return {
        "condition": pl.repeat(curves.name, len(curves.times), eager=True),
        "move": _moves(curves),
        "trials": pl.repeat(len(curves.values), len(curves.times), dtype=pl.Int64, eager=True),
        "mean": curves.values.mean(axis=0),
        "low": unknown if band is None else pl.Series(band.low),
        "high": unknown if band is None else pl.Series(band.high),
    }


def _moves(curves: Curves) -> pl.Series:
    return pl.Series(curves.times.astype(np.int64))


def _one_a_move(best_paths: pl.DataFrame, notes: list[str]) -> pl.DataFrame:
    """A restarted learner goes on from its checkpoint and may report a move again: the last report counts."""
    ordered = best_paths.sort("epoch", "sequence", maintain_order=True)
    once = ordered.unique(["log", "robot", "move"], keep="last", maintain_order=True)
    if once.height < best_paths.height:
        count = best_paths.height - once.height
        notes.append(f"{count} points were reported again after a restart; the last report counts")
    return once


def _curves(condition: str, points: pl.DataFrame, scale: Scale, notes: list[str]) -> Curves:
    """The curves of one condition at the moves that all of its learners reported."""
    learners = points.group_by("seed", "trial", "robot", maintain_order=True).len().height
    counted = points.group_by("move").len().sort("move")
    common = counted.filter(pl.col("len") == learners)["move"]
    if common.is_empty():
        raise UserError(f"{condition}: its trials have no move in common; analyze them one by one")
    _note_cut(condition, counted["move"].to_numpy(), common.to_numpy(), points, notes)
    mean = (
        points.filter(pl.col("move").is_in(common.implode()))
        .group_by("seed", "trial", "move")
        .agg(pl.col("length").mean())
        .sort("seed", "trial", "move")
    )
    replicates = tuple(mean.select("seed", "trial").unique(maintain_order=True).iter_rows())
    values = mean["length"].to_numpy().astype(np.float64).reshape(len(replicates), len(common))
    return Curves(condition, common.to_numpy().astype(np.float64), values, replicates, scale)


def _note_cut(
    condition: str, reported: FloatArray, common: FloatArray, points: pl.DataFrame, notes: list[str]
) -> None:
    end = int(common[-1])
    if reported[-1] > end:
        ends = (
            points.group_by("seed", "trial", "robot").agg(pl.col("move").max()).sort("move", "seed", "trial")
        )
        shortest = ends.row(0, named=True)
        notes.append(
            f"{condition}: cut to {end} moves, where {shortest['robot']} ends in trial {shortest['trial']} "
            f"of seed {shortest['seed']}; the longest trial goes on to {int(reported[-1])}"
        )
    inside = int((reported <= end).sum()) - len(common)
    if inside:
        notes.append(f"{condition}: {inside} points are missing in some trial and were left out of all")


def _cap(best_paths: pl.DataFrame, notes: list[str]) -> int:
    caps = best_paths["cap"].unique().sort().to_list()
    if len(caps) > 1:
        notes.append(
            f"the logs count a path that does not arrive differently, as {', '.join(map(str, caps))}"
        )
    return int(caps[-1])
