"""Drawings of arenas and paths: figures 1, 2, 4, 10, 11 and 13."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from swarm.experiments.study import Drawing
from swarm.geometry import Grid, Move


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
    axes.plot([column], [row], marker, markersize=9, label=label, zorder=3)
