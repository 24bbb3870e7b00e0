"""One robot's learning, move by move: what a page needs to show its table, memory and place at any move."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import polars as pl

from swarm.analysis.page.curves import rounded
from swarm.analysis.page.sources import Sources
from swarm.geometry import Move
from swarm.logs.identity import LogIdentity
from swarm.messages import topics

LARGEST_BYTES = 7_000_000
"""Of all robots' learning in a page whose file is to stay below 10 MB."""


def page_learning(tables: Mapping[str, Path], sources: Sources) -> tuple[list[dict[str, Any]], int]:
    """The learners of all trials, trial by trial, as long as there is room; and how many are left out."""
    frames = {
        name: pl.read_parquet(tables[name], glob=False)
        for name in ("moves", "paths", "replays", "best_paths")
    }
    found: list[dict[str, Any]] = []
    left_out = size_bytes = 0
    for log, robot in _learners(sources.logs):
        of_robot = {
            name: frame.filter(pl.col("log") == log.trial_log, pl.col("robot") == robot)
            for name, frame in frames.items()
        }
        one = _learning(of_robot, log, robot, sources)
        size_bytes += len(json.dumps(one))
        if size_bytes > LARGEST_BYTES:
            left_out += 1
        else:
            found.append(one)
    return found, left_out


def _learners(logs: Sequence[LogIdentity]) -> Iterator[tuple[LogIdentity, str]]:
    """Each trial's once, of the first of its logs."""
    first = {log.trial_log: log for log in reversed(logs)}
    for log in logs:
        if first[log.trial_log] is log:
            for robot in sorted(log.learners):
                yield log, robot


def _learning(
    frames: Mapping[str, pl.DataFrame], log: LogIdentity, robot: str, sources: Sources
) -> dict[str, Any]:
    moves = last_life(frames["moves"], "number")
    logs = sources.of_trial(log.trial_log)
    keys = [topic.key(robot) for topic in (topics.MOVE, topics.PATH, topics.REPLAY)]
    how = "Q by the values that the robot reported with its moves; R by its replays"
    grid = log.grid
    return {
        "robot": robot,
        "condition": log.condition(robot),
        "seed": log.seed,
        "trial": log.trial,
        "columns": grid.columns,
        "rows": grid.rows,
        "start": grid.start,
        "goal": grid.goal,
        "source": sources.of(logs, keys, how),
        "number": moves["number"].to_list(),
        "track": moves["track"].to_list(),
        "state": moves["state"].to_list(),
        "action": [int(Move[name]) if name else None for name in moves["action"].to_list()],
        "next_state": moves["next_state"].to_list(),
        "q_value": rounded(moves["q_value"].to_numpy()),
        "path": moves["path"].to_list(),
        "t_s": rounded(moves["t_s"].round(1).to_numpy()),
        "best": _best(frames["best_paths"]),
        "remembered": _remembered(frames["paths"], moves),
        "replays": _replays(frames["replays"], moves),
    }


def last_life(rows: pl.DataFrame, counter: str) -> pl.DataFrame:
    """A robot whose process started again went on from an earlier move, or anew: what it had done since is
    not part of what it knows.
    """
    rows = rows.sort("epoch", "sequence", maintain_order=True)
    firsts = rows.group_by("epoch", maintain_order=True).agg(pl.col(counter).first())
    for epoch, first in firsts.iter_rows():
        rows = rows.filter((pl.col("epoch") >= epoch) | (pl.col(counter) < first))
    return rows.unique(counter, keep="last", maintain_order=True)


def _best(best_paths: pl.DataFrame) -> dict[str, list[int]]:
    once = last_life(best_paths, "move")
    return {"move": once["move"].to_list(), "length": once["length"].to_list()}


def _remembered(paths: pl.DataFrame, moves: pl.DataFrame) -> list[dict[str, Any]]:
    once = paths.sort("publish_t_ns", maintain_order=True).unique("path", keep="last", maintain_order=True)
    return [
        {
            "path": row["path"],
            "moves": row["moves"],
            "from": row["source"],
            "visit": row["visit"],
            "after": row["after"],
        }
        for row in _after(once, moves).iter_rows(named=True)
    ]


def _replays(replays: pl.DataFrame, moves: pl.DataFrame) -> dict[str, list[Any]]:
    """Each replay that ended, after which move, and R from then on."""
    found = _after(replays.sort("publish_t_ns", maintain_order=True), moves)
    return {
        "after": found["after"].to_list(),
        "path": found["path"].to_list(),
        "ratio": rounded(found["ratio"].to_numpy()),
        "outcome": found["outcome"].to_list(),
    }


def _after(rows: pl.DataFrame, moves: pl.DataFrame) -> pl.DataFrame:
    """With the number of the robot's last move at the time of each row; 0 before the first."""
    made = moves.select("publish_t_ns", after="number").sort("publish_t_ns")
    joined = rows.join_asof(made, on="publish_t_ns", check_sortedness=False)
    return joined.with_columns(pl.col("after").fill_null(0))
