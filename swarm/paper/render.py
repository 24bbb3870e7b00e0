"""One figure's files and numbers, from the runs on the disk."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swarm.files import write_png
from swarm.gridworld.arena import shortest_path
from swarm.paper.options import Settings
from swarm.paper.results import Results
from swarm.paper.store import RunStore, Timing
from swarm.paper.study import Drawing, Figure, Study
from swarm.table_files import write_table

if TYPE_CHECKING:
    import polars as pl


def render(figure: Figure, store: RunStore, settings: Settings) -> dict[str, Any]:
    """Write the figure's plot, and table if it has one; return its numbers as plain data."""
    started_s = time.perf_counter()
    if isinstance(figure, Drawing):
        shown = _render_drawing(figure, store.root / "drawings")
    else:
        shown = _render_study(figure, Results(store, settings.runs_of(figure)))
    return {"title": figure.title, **shown, "rendering_s": round(time.perf_counter() - started_s, 3)}


def results_folder(results: Results) -> Path:
    """Where the tables and plots of so many runs go: those of fewer runs, and of other readings, stay."""
    readings = "".join(f"@{name}={word}" for name, word in results.store.readings.chosen.items())
    return results.store.root / f"{results.runs}-runs{readings}"


def render_plot(study: Study, results: Results) -> Path:
    """Only the plot of a study."""
    from swarm.paper.plots import plot_study

    path = results_folder(results) / f"{study.name}.png"
    path.parent.mkdir(exist_ok=True)
    return write_png(plot_study(study, results), path)


def _render_drawing(drawing: Drawing, folder: Path) -> dict[str, Any]:
    from swarm.paper.plots import draw

    folder.mkdir(exist_ok=True)
    write_png(draw(drawing), folder / f"{drawing.name}.png")
    paths = {label: [move.name for move in moves] for label, (_, moves) in drawing.paths.items()}
    grid = {
        "columns": drawing.grid.columns,
        "rows": drawing.grid.rows,
        "obstacle_cells": len(drawing.grid.obstacle),
    }
    files = {"png": str(folder / f"{drawing.name}.png")}
    return {
        "files": files,
        "grid": grid,
        "paths": paths,
        "curves": {},
        "R": {},
        "seconds": 0.0,
        "steps_per_s": None,
    }


def _render_study(study: Study, results: Results) -> dict[str, Any]:
    from swarm.paper.tables import curve_table, ratio_table

    table = curve_table(study, results)
    plot = render_plot(study, results)
    parquet = plot.with_suffix(".parquet")
    write_table(table, parquet)
    return {
        "runs": results.runs,
        "seed": results.store.seed,
        "files": {"png": str(plot), "parquet": str(parquet)},
        "curves": _curves(table),
        "R": ratio_table(study, results),
        "score": _scores(study, results),
        **_speed(study, results),
    }


def _curves(table: pl.DataFrame) -> dict[str, Any]:
    shown = table.select("series", "condition", "step", "mean", "low", "high")
    return {
        str(part["series"][0]): {
            "condition": part["condition"][0],
            **part.drop("series", "condition").to_dict(as_series=False),
        }
        for part in shown.partition_by("series", maintain_order=True)
    }


def _scores(study: Study, results: Results) -> dict[str, Any]:
    return {
        label: dict(
            study.score(results.curves(condition, study.horizon_steps), shortest_path(condition.arena))
        )
        for label, condition in study.series.items()
    }


def _speed(study: Study, results: Results) -> dict[str, float | None]:
    """Seconds that the engine took for the runs shown, and its steps a second of one core."""
    timings = _timings(study, results)
    seconds, steps = sum(timing.seconds for timing in timings), sum(timing.steps for timing in timings)
    return {"seconds": round(seconds, 6), "steps_per_s": round(steps / seconds, 1) if seconds else None}


def _timings(study: Study, results: Results) -> list[Timing]:
    names = {results.store.condition(condition).name for condition in study.series.values()}
    timings = results.store.timings().values()
    return [timing for timing in timings if timing.condition in names and timing.run < results.runs]
