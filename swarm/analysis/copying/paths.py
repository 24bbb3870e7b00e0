"""The paths that robots remembered: how often each was enacted, its R, where it was seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from swarm.analysis.copying.errors import ErrorKind, contains, error_kind
from swarm.geometry import Move
from swarm.learning.alignment import edit_distance

OF_PATH = ["log", "robot", "path"]
FIRST_R = 1.0
"""R of a path that was never replayed (eq. 2 and 4)."""


@dataclass(frozen=True)
class LoggedPath:
    """One path of one robot's memory. `real` and `copied` are the moves of the whole demonstration, of
    which `moves` is the stretch that was remembered; both are None if no copying error is known, as for a
    path that was given.
    """

    log: str
    condition: str
    robot: str
    seed: int
    trial: int
    path: int
    visit: int
    """The visit that it was copied in; 0 for a path that was given."""
    moves: tuple[int, ...]
    source: str
    known_from: int
    """How many moves the robot had made when it remembered the path."""
    known_for: int
    """How many it has made since."""
    replays: int
    ratio: float
    """R after the last replay."""
    real: tuple[int, ...] | None
    copied: tuple[int, ...] | None

    @property
    def error(self) -> ErrorKind | None:
        """The kind of the copying error; None if it is not known."""
        return None if self.real is None or self.copied is None else error_kind(self.copied, self.real)

    @property
    def edit_distance(self) -> int | None:
        return None if self.real is None or self.copied is None else edit_distance(self.copied, self.real)

    @property
    def really_made(self) -> bool | None:
        """Whether the demonstrator really made the remembered moves, whatever else was miscopied."""
        return None if self.real is None else contains(self.real, self.moves)

    def row(self) -> dict[str, Any]:
        """As a line of the table `copied_paths`."""
        moves = {"moves": _names(self.moves), "real": _names(self.real), "copied": _names(self.copied)}
        error = {"error": self.error, "edit_distance": self.edit_distance, "really_made": self.really_made}
        return vars(self) | moves | error


def read_paths(tables: Mapping[str, Path]) -> list[LoggedPath]:
    """From the tables of paths, replays, moves and, where there were visits, copying errors."""
    paths = pl.read_parquet(tables["paths"], glob=False).unique(OF_PATH, keep="last", maintain_order=True)
    replays = pl.read_parquet(tables["replays"], glob=False).sort("receive_t_ns", maintain_order=True)
    counted = replays.group_by(OF_PATH).agg(replays=pl.len(), ratio=pl.last("ratio"))
    joined = (
        _with_moves(paths, pl.read_parquet(tables["moves"], glob=False))
        .join(counted, on=OF_PATH, how="left", maintain_order="left")
        .join(_judged(tables), on=OF_PATH, how="left", maintain_order="left")
    )
    return [_path(row) for row in joined.iter_rows(named=True)]


def path_table(paths: Sequence[LoggedPath]) -> pl.DataFrame:
    """A row for each path."""
    return pl.DataFrame([path.row() for path in paths], schema=_SCHEMA)


_SCHEMA: dict[str, Any] = {
    "log": pl.String,
    "condition": pl.String,
    "robot": pl.String,
    "seed": pl.Int64,
    "trial": pl.Int64,
    "path": pl.Int64,
    "visit": pl.Int64,
    "moves": pl.List(pl.String),
    "source": pl.String,
    "known_from": pl.Int64,
    "known_for": pl.Int64,
    "replays": pl.Int64,
    "ratio": pl.Float64,
    "real": pl.List(pl.String),
    "copied": pl.List(pl.String),
    "error": pl.String,
    "edit_distance": pl.Int64,
    "really_made": pl.Boolean,
}


def _with_moves(paths: pl.DataFrame, moves: pl.DataFrame) -> pl.DataFrame:
    """`known_from`: number of the robot's last move before a path; `last_move`: of its last move at all."""
    by_robot = ["log", "robot"]
    made = moves.select(*by_robot, "receive_t_ns", known_from="number").sort("receive_t_ns")
    last = moves.group_by(by_robot).agg(last_move=pl.col("number").max())
    return (
        paths.sort("receive_t_ns", maintain_order=True)
        .join_asof(made, on="receive_t_ns", by=by_robot, check_sortedness=False)
        .join(last, on=by_robot, how="left", maintain_order="left")
        .with_columns(pl.col("known_from", "last_move").fill_null(0))
    )


def _judged(tables: Mapping[str, Path]) -> pl.DataFrame:
    """The real and the copied moves of every path that the server judged."""
    if "copy_errors" not in tables:
        return pl.DataFrame(schema=dict.fromkeys(OF_PATH[:2], pl.String) | {"path": pl.Int64, **_NO_MOVES})
    errors = pl.read_parquet(tables["copy_errors"], glob=False).filter(pl.col("path") > 0)
    return errors.select(*OF_PATH, *_NO_MOVES).unique(OF_PATH, keep="last", maintain_order=True)


_NO_MOVES = {"true_moves": pl.List(pl.String), "copied_moves": pl.List(pl.String)}


def _path(row: Mapping[str, Any]) -> LoggedPath:
    origin = {name: row[name] for name in ("log", "condition", "robot", "seed", "trial", "path", "visit")}
    return LoggedPath(
        **origin,
        moves=_moves(row["moves"]),
        source=row["source"],
        known_from=row["known_from"],
        known_for=row["last_move"] - row["known_from"],
        replays=row["replays"] or 0,
        ratio=FIRST_R if row["ratio"] is None else row["ratio"],
        real=None if row["true_moves"] is None else _moves(row["true_moves"]),
        copied=None if row["copied_moves"] is None else _moves(row["copied_moves"]),
    )


def _moves(names: Sequence[str]) -> tuple[int, ...]:
    return tuple(int(Move[name]) for name in names)


def _names(moves: Sequence[int] | None) -> list[str] | None:
    return None if moves is None else [Move(move).name for move in moves]


Seen = tuple[tuple[float, float], ...]
"""(cells to the east, cells to the south) of where the demonstration began."""


def seen_positions(tables: Mapping[str, Path], path: LoggedPath, cell_m: float) -> Seen:
    """The positions within the demonstration, in cells; none if the log lacks the observation."""
    if not {"segments", "smoothed"} <= tables.keys():
        return ()
    began_t_ns, ended_t_ns = _span(_of_visit(tables["segments"], path))
    of_visit = _of_visit(tables["smoothed"], path)
    places = of_visit.filter(pl.col("captured_t_ns").is_between(began_t_ns, ended_t_ns))
    places = places.sort("captured_t_ns").select("x_m", "y_m")
    if places.is_empty():
        return ()
    west_m, north_m = places.row(0)
    return tuple(((x_m - west_m) / cell_m, (north_m - y_m) / cell_m) for x_m, y_m in places.iter_rows())


def _of_visit(table: Path, path: LoggedPath) -> pl.DataFrame:
    rows = pl.scan_parquet(table, glob=False)
    return rows.filter(log=path.log, robot=path.robot, visit=path.visit).collect()


def _span(segments: pl.DataFrame) -> tuple[int, int]:
    """Beginning and end in ns; an empty span for none."""
    if segments.is_empty():
        return 1, 0
    return int(segments["began_t_ns"].min()), int(segments["ended_t_ns"].max())  # type: ignore[arg-type]
