"""A study's curves with their bands, as one table; and its R values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from swarm.gridworld.condition import Condition, GivenPaths
from swarm.learning.random import spawned_generator
from swarm.paper.results import Results
from swarm.paper.study import Study
from swarm.statistics.averages import average, weighted_iqm
from swarm.statistics.intervals import FEWEST, Band, ends_of, interval, sample_interval, simultaneous_band
from swarm.statistics.samples import Curves, FloatArray, Scale

if TYPE_CHECKING:
    import polars as pl


def curve_table(study: Study, results: Results) -> pl.DataFrame:
    """A row for each series and tested point: interquartile mean, mean, and the mean's 95 % bands.

    `low` and `high` hold at each point on its own, `simultaneous_low` and `_high` over the whole curve.
    """
    import polars as pl

    return pl.concat(
        _series_table(label, results.tested(condition, study.horizon_steps), results.store.seed)
        for label, condition in study.series.items()
    )


def ratio_table(study: Study, results: Results) -> dict[str, dict[str, dict[str, float | None]]]:
    """series -> path -> the mean R value over runs with its 95 % interval; only series with a memory."""
    tables = {
        label: _ratios(condition, results.ratios(condition)) for label, condition in study.series.items()
    }
    return {label: table for label, table in tables.items() if table}


def path_names(condition: Condition, places: int) -> list[str]:
    """What the places of a memory hold: the moves given, or, of paths copied on the way, their number."""
    if isinstance(condition.teacher, GivenPaths):
        return [_path_name([move.name for move in path.moves]) for path in condition.teacher.paths]
    return [f"path {place + 1}" for place in range(places)]


SCALE_OF_R = Scale(0.0, 1.0)
"""Eq. 2 and 4 are fractions."""


def _series_table(label: str, curves: Curves, seed: int) -> pl.DataFrame:
    import polars as pl

    rng = spawned_generator(seed, curves.name, len(curves.values), "curves", "bootstrap")
    columns: dict[str, Any] = {"step": curves.times.astype(np.int64), "mean": average(curves.values)}
    columns["iqm"] = average(curves.values, weighted_iqm)
    for name, band in _bands(curves, rng).items():
        columns[f"{name}low"], columns[f"{name}high"] = band.low, band.high
    named = [pl.lit(label).alias("series"), pl.lit(curves.name).alias("condition")]
    frame = pl.DataFrame(columns).select(*named, pl.all())
    return frame.with_columns(pl.selectors.float().fill_nan(None))


def _bands(curves: Curves, rng: np.random.Generator) -> dict[str, Band]:
    """All of one kind: where the runs are too few for one interval, they are for every one."""
    pointwise, values = interval(curves), curves.values
    if pointwise is None:
        unknown = np.full(values.shape[1], np.nan)
        return dict.fromkeys(("", "simultaneous_"), Band(unknown, unknown, unknown))
    return {"": pointwise, "simultaneous_": simultaneous_band(values, rng, ends_of(curves))}


def _ratios(condition: Condition, ratios: FloatArray) -> dict[str, dict[str, float | None]]:
    rows = {}
    for name, column in zip(path_names(condition, ratios.shape[1]), ratios.T, strict=True):
        known = column[np.isfinite(column)]
        band = sample_interval(known[:, None], SCALE_OF_R) if len(known) >= FEWEST else None
        low, high = (None, None) if band is None else (float(band.low[0]), float(band.high[0]))
        rows[name] = {"mean": float(known.mean()), "low": low, "high": high}
    return rows


def _path_name(moves: list[str]) -> str:
    return f"{len(moves)} x {moves[0]}" if len(set(moves)) == 1 else "-".join(moves)
