"""A study's curves with their bands, as one table; and its R values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from swarm.gridworld.condition import Condition, GivenPaths
from swarm.learning.random import spawned_generator
from swarm.paper.results import Results
from swarm.paper.study import Study
from swarm.statistics.intervals import (
    Band,
    average,
    bootstrap_bands,
    pointwise_t_band,
    simultaneous_band,
    weighted_iqm,
)
from swarm.statistics.samples import Curves, FloatArray

if TYPE_CHECKING:
    import polars as pl


def curve_table(study: Study, results: Results) -> pl.DataFrame:
    """A row for each series and tested point: mean and interquartile mean, each with 95 % bands.

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


def finite(values: FloatArray) -> list[float | None]:
    """For JSON, which knows no NaN."""
    return [float(value) if np.isfinite(value) else None for value in values]


def _series_table(label: str, curves: Curves, seed: int) -> pl.DataFrame:
    import polars as pl

    rng = spawned_generator(seed, curves.name, len(curves.values), "curves", "bootstrap")
    columns: dict[str, Any] = {"step": curves.times.astype(np.int64), "mean": average(curves.values)}
    columns["iqm"] = average(curves.values, weighted_iqm)
    for name, band in _bands(curves.values, rng).items():
        columns[f"{name}low"], columns[f"{name}high"] = band.low, band.high
    named = [pl.lit(label).alias("series"), pl.lit(curves.name).alias("condition")]
    frame = pl.DataFrame(columns).select(*named, pl.all())
    return frame.with_columns(pl.selectors.float().fill_nan(None))


def _bands(values: FloatArray, rng: np.random.Generator) -> dict[str, Band]:
    if len(values) < 2:
        unknown = np.full(values.shape[1], np.nan)
        names = ("", "simultaneous_", "iqm_", "iqm_simultaneous_")
        return dict.fromkeys(names, Band(unknown, unknown, unknown))
    iqm, simultaneous_iqm = bootstrap_bands(values, rng, weighted_iqm, resamples=1000)
    return {
        "": pointwise_t_band(values),
        "simultaneous_": simultaneous_band(values, rng),
        "iqm_": iqm,
        "iqm_simultaneous_": simultaneous_iqm,
    }


def _ratios(condition: Condition, ratios: FloatArray) -> dict[str, dict[str, float | None]]:
    rows = {}
    for name, column in zip(path_names(condition, ratios.shape[1]), ratios.T, strict=True):
        known = column[np.isfinite(column)]
        half = pointwise_t_band(known[:, None]).high[0] - known.mean() if len(known) > 1 else np.nan
        low, high = finite(np.array([known.mean() - half, known.mean() + half]))
        rows[name] = {"mean": float(known.mean()), "low": low, "high": high}
    return rows


def _path_name(moves: list[str]) -> str:
    return f"{len(moves)} x {moves[0]}" if len(set(moves)) == 1 else "-".join(moves)
