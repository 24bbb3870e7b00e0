"""A robot's Q-table at a move: as a table, and as a map with the arrows of the best moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
from matplotlib.figure import Figure

from swarm.files import write_png
from swarm.geometry import Grid, Move
from swarm.learning.q_table import QTable
from swarm.table_files import write_table

ARROW = 0.6
"""In cells: arrows of two neighbours do not touch."""


def write_moment(folder: Path, name: str, q: QTable, grid: Grid) -> list[Path]:
    """`NAME.csv` and `NAME.png`."""
    folder.mkdir(parents=True, exist_ok=True)
    table = write_table(q_frame(q, grid), folder / f"{name}.csv")
    return [table, write_png(draw_q(q, grid, name), folder / f"{name}.png")]


def q_frame(q: QTable, grid: Grid) -> pl.DataFrame:
    """A row a state, a column a move."""
    states = range(grid.states)
    cells = {"state": states, "column": [state % grid.columns for state in states]}
    cells |= {"row": [state // grid.columns for state in states]}
    return pl.DataFrame(cells | {move.name: [q.values[state][move] for state in states] for move in Move})


def draw_q(q: QTable, grid: Grid, title: str) -> Figure:
    """The best Q value of each cell, and its best moves where they are known."""
    best = np.array([q.best_value(state) for state in range(grid.states)]).reshape(grid.rows, grid.columns)
    figure = Figure(figsize=(7, 6), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(best, cmap="viridis")
    figure.colorbar(image, label="best Q value")
    arrows = [(*grid.cell(state), Move(move)) for state, move in _known_moves(q, grid)]
    axes.quiver(
        [column for column, _, _ in arrows],
        [row for _, row, _ in arrows],
        [ARROW * move.columns for _, _, move in arrows],
        [ARROW * move.rows for _, _, move in arrows],
        angles="xy",
        scale_units="xy",
        scale=1,
        pivot="mid",
        color="white",
    )
    axes.set(title=title, xlabel="column, from the west", ylabel="row, from the north")
    return figure


def _known_moves(q: QTable, grid: Grid) -> list[tuple[int, int]]:
    """Each state's best moves; none where nothing has been learnt."""
    return [
        (state, move)
        for state in range(grid.states)
        if q.best_value(state) > 0
        for move in q.best_actions(state)
    ]
