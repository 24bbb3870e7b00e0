"""Where an observer believed that the demonstrator was while it made the moves that were copied."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import polars as pl

from swarm.analysis.copied_paths import RememberedPath

Seen = tuple[tuple[float, float], ...]
"""(cells to the east, cells to the south) of where the demonstration began."""


def seen_positions(tables: Mapping[str, Path], path: RememberedPath, cell_m: float) -> Seen:
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


def _of_visit(table: Path, path: RememberedPath) -> pl.DataFrame:
    return pl.scan_parquet(table).filter(log=path.log, robot=path.robot, visit=path.visit).collect()


def _span(segments: pl.DataFrame) -> tuple[int, int]:
    """Beginning and end in ns; an empty span for none."""
    if segments.is_empty():
        return 1, 0
    return int(segments["began_t_ns"].min()), int(segments["ended_t_ns"].max())  # type: ignore[arg-type]
