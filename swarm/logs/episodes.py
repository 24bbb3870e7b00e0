"""What a log's messages tell together: one row a journey from start to goal, one row a visit."""

from __future__ import annotations

import polars as pl

_ONE = ["log", "seed", "trial", "condition", "robot"]


def journeys(moves: pl.DataFrame) -> pl.DataFrame:
    """A row for each `track` of a robot, from its first choice to its last move."""
    first = pl.col("t_s") - pl.col("duration_s")
    return (
        moves.group_by(*_ONE, "track", maintain_order=True)
        .agg(
            began_t_s=first.min(),
            ended_t_s=pl.col("t_s").max(),
            first_move=pl.col("number").min(),
            moves=pl.len().cast(pl.Int64),
            blocked_moves=pl.col("blocked").sum().cast(pl.Int64),
            replayed_moves=(pl.col("path") > 0).sum().cast(pl.Int64),
            moving_s=pl.col("duration_s").sum(),
            arrived=(pl.col("reward") > 0).any(),
        )
        .sort("log", "robot", "track")
    )


def visits(phases: pl.DataFrame, observations: pl.DataFrame, copy_errors: pl.DataFrame) -> pl.DataFrame:
    """A row for each visit of an observer: when, what it remembered, and what was really done meanwhile."""
    of_visit = ["log", "robot", "visit"]
    done = pl.col("phase") == "DONE"
    seen = observations.select(*of_visit, "profile", "frames", copied_moves="moves")
    judged = copy_errors.select(*of_visit, "demonstrator", "true_moves", "edit_distance")
    return (
        phases.group_by(*_ONE, "visit", maintain_order=True)
        .agg(
            ready_t_s=_first("READY"),
            watching_t_s=_first("WATCHING"),
            done_t_s=_first("DONE"),
            path=pl.col("path").filter(done).last(),
            reason=pl.col("reason").filter(done).last(),
        )
        .join(seen.unique(of_visit, keep="last"), on=of_visit, how="left")
        .join(judged.unique(of_visit, keep="last"), on=of_visit, how="left")
        .sort("log", "robot", "visit")
    )


def _first(phase: str) -> pl.Expr:
    return pl.col("t_s").filter(pl.col("phase") == phase).min()
