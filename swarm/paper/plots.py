"""The figures in the paper's form: learning curves with 95 % intervals, R values, arenas and paths."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swarm.geometry import Grid, Move
from swarm.paper.results import Results
from swarm.paper.study import Drawing, Shown, Study
from swarm.paper.tables import ratio_table
from swarm.statistics.plots import EACH_IS_DRAWN, draw_band, draw_error_bars, interval_words
from swarm.statistics.samples import Curves

DRAWN_POINTS = 2000
"""More than a picture has pixels for."""
COLOURS = ("black", "tab:red", "tab:blue", "tab:green", "tab:orange", "tab:purple")


def plot_study(study: Study, results: Results) -> Figure:
    """The study's plot."""
    figure = Figure(figsize=(8.8, 4.4), layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(study.title, fontsize="medium", wrap=True)
    if study.shown is Shown.RATIOS:
        _draw_ratios(axes, study, results)
    else:
        _draw_curves(axes, study, results)
    return figure


def _draw_curves(axes: Axes, study: Study, results: Results) -> None:
    for (label, condition), colour in zip(study.series.items(), _colours(len(study.series)), strict=True):
        curves = results.curves(condition, study.horizon_steps)
        _draw_mean(axes, curves, study, label, colour)
    unit = "time units" if study.time_unit_steps == 1 else f"{study.time_unit_steps} time units"
    axes.set_xlabel(f"Time ({unit})")
    axes.set_ylabel("Best path length")
    axes.set_xlim(0, results.horizon(study.horizon_steps) / study.time_unit_steps)
    axes.set_ylim(bottom=0)
    _add_legend(axes, interval_words(results.runs, "run"))


def _draw_mean(axes: Axes, curves: Curves, study: Study, label: str, colour: str) -> None:
    """The mean at all points; intervals at every 10th where the paper says so, else as a band.

    A page has room for some 2,000 points; of more, evenly spaced ones are drawn.
    """
    thinned = curves.every(max(1, len(curves.times) // DRAWN_POINTS))
    drawn = replace(thinned, times=thinned.times / study.time_unit_steps)
    axes.plot(drawn.times, drawn.values.mean(axis=0), color=colour, label=label, linewidth=1)
    if study.interval_points == 1:
        draw_band(axes, drawn, colour)
    else:
        draw_error_bars(axes, drawn, colour, first=0, every=study.interval_points)


def _draw_ratios(axes: Axes, study: Study, results: Results) -> None:
    """A bar for each path, with the 95 % interval of its mean, and a dot for each of few runs."""
    tables = ratio_table(study, results)
    width = 0.8 / max(1, len(tables))
    for place, (label, table) in enumerate(tables.items()):
        low, mean, high = (
            np.array([row[name] for row in table.values()], float) for name in ("low", "mean", "high")
        )
        at = np.arange(len(table)) + (place - (len(tables) - 1) / 2) * width
        errors = np.nan_to_num([mean - low, high - mean])
        axes.bar(at, mean, width, yerr=errors if errors.any() else None, capsize=3, label=label)
        if 1 < results.runs < EACH_IS_DRAWN:
            axes.plot(at, results.ratios(study.series[label]).T, ".", color="black", markersize=4)
        axes.set_xticks(np.arange(len(table)), list(table))
    axes.set_xlabel("Path")
    axes.set_ylabel("R")
    axes.set_ylim(bottom=0)
    _add_legend(axes, interval_words(results.runs, "run"))


def _add_legend(axes: Axes, title: str) -> None:
    """Beside the axes, where it hides nothing."""
    axes.legend(
        title=title,
        title_fontsize="small",
        fontsize="small",
        loc="upper left",
        bbox_to_anchor=(1.0, 1.0),
        frameon=False,
        alignment="left",
    )


def _colours(count: int) -> list[str]:
    return [COLOURS[place % len(COLOURS)] for place in range(count)]


def draw(drawing: Drawing) -> Figure:
    """The arena from above, north up; obstacles are dark, paths are arrows through the cells' centres."""
    figure = Figure(figsize=(5, 5), layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(drawing.title, fontsize="medium")
    axes.imshow(_obstacles(drawing.grid), cmap="Greys", vmin=0, vmax=1.3, extent=_extent(drawing.grid))
    _draw_cells(axes, drawing.grid)
    for label, (start, moves) in drawing.paths.items():
        _draw_path(axes, label, start, moves)
        if not drawing.marks_ends:
            axes.annotate(label, cells_of(start, moves)[-1], textcoords="offset points", xytext=(4, 6))
    if drawing.marks_ends:
        _mark(axes, drawing.grid, drawing.grid.start, "o", "agent")
        _mark(axes, drawing.grid, drawing.grid.goal, "*", "goal")
        axes.legend(loc="upper right", fontsize="small")
    return figure


def cells_of(start: tuple[int, int], moves: tuple[Move, ...]) -> list[tuple[int, int]]:
    """The cells (column, row) that a path visits."""
    columns = accumulate((move.columns for move in moves), initial=start[0])
    rows = accumulate((move.rows for move in moves), initial=start[1])
    return list(zip(columns, rows, strict=True))


def _obstacles(grid: Grid) -> np.ndarray:
    cells = np.zeros(grid.states)
    cells[list(grid.obstacle)] = 1
    return cells.reshape(grid.rows, grid.columns)


def _extent(grid: Grid) -> tuple[float, float, float, float]:
    return (-0.5, grid.columns - 0.5, grid.rows - 0.5, -0.5)


def _draw_cells(axes: Axes, grid: Grid) -> None:
    axes.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    if grid.columns <= 50:
        axes.set_xticks(np.arange(grid.columns + 1) - 0.5)
        axes.set_yticks(np.arange(grid.rows + 1) - 0.5)
        axes.grid(color="0.8", linewidth=0.5)


def _draw_path(axes: Axes, label: str, start: tuple[int, int], moves: tuple[Move, ...]) -> None:
    columns, rows = zip(*cells_of(start, moves), strict=True)
    (line,) = axes.plot(columns, rows, linewidth=1.5, label=label)
    axes.annotate(
        "",
        xy=(columns[-1], rows[-1]),
        xytext=(columns[-2], rows[-2]),
        arrowprops={"arrowstyle": "->", "color": line.get_color(), "linewidth": 1.5},
    )


def _mark(axes: Axes, grid: Grid, state: int, marker: str, label: str) -> None:
    column, row = grid.cell(state)
    axes.plot([column], [row], marker, markersize=9, label=label, zorder=3, clip_on=False)
