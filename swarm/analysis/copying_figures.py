"""Figures 27 to 29 for any run: paths enacted most and least, originals beside copies, R over time."""

from __future__ import annotations

from collections.abc import Sequence

import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from swarm.analysis.copied_paths import PERFECT, Copying, RememberedPath
from swarm.analysis.run_figures import COLOURS, GREY
from swarm.geometry import Move

SHOWN = 4
ROBOTS_SHOWN = 4


def copying_figures(copying: Copying) -> dict[str, Figure]:
    """Every figure that the run has something for, by file name."""
    found: dict[str, Figure] = {}
    enacted = copying.enacted
    if enacted:
        found["most_enacted.png"] = plot_paths(enacted, "paths enacted most often")
        found["least_enacted.png"] = plot_paths(enacted[::-1], "paths enacted least often")
    if copies := plot_copies(copying):
        found["copies.png"] = copies
    if not copying.replays.is_empty():
        found["ratios.png"] = plot_ratios(copying.replays)
    return found


def plot_paths(paths: Sequence[RememberedPath], title: str) -> Figure:
    """Remembered paths side by side, at relative positions, with their R and replays."""
    shown = paths[:SHOWN]
    figure = Figure(figsize=(2.6 * len(shown), 3.2), layout="constrained")
    figure.suptitle(title, fontsize=11, fontweight="bold", x=0.02, ha="left")
    for axes, path in zip(_row(figure, len(shown)), shown, strict=True):
        _draw_moves(axes, path.moves, COLOURS[0])
        ratio = "–" if path.ratio is None else f"{path.ratio:.2f}"
        axes.set_title(f"{path.robot}, path {path.path}\n{path.replays:,} replays, R {ratio}", fontsize=8.5)
    return figure


def plot_copies(copying: Copying) -> Figure | None:
    """What the demonstrator did above, what was perceived below: the most enacted and the worst copied."""
    shown = chosen_copies(copying)
    if not shown:
        return None
    figure = Figure(figsize=(2.6 * len(shown), 5.4), layout="constrained")
    figure.suptitle("original (above) and copy (below)", fontsize=11, fontweight="bold", x=0.02, ha="left")
    rows = figure.subplots(2, len(shown), squeeze=False)
    for place, path in enumerate(shown):
        _draw_moves(rows[0][place], path.real or (), GREY)
        _draw_moves(rows[1][place], path.copied or (), COLOURS[0] if path.error == PERFECT else COLOURS[1])
        rows[0][place].set_title(f"{path.robot}, path {path.path}", fontsize=8.5)
        rows[1][place].set_title(f"{path.error}, {path.replays:,} replays", fontsize=8.5)
    return figure


def chosen_copies(copying: Copying) -> list[RememberedPath]:
    """The two most enacted copies, then the miscopied ones that were enacted most."""
    judged = [path for path in copying.enacted if path.error]
    miscopied = [path for path in judged if path.error != PERFECT]
    return list(dict.fromkeys([*judged[:2], *miscopied]))[:SHOWN]


def plot_ratios(replays: pl.DataFrame) -> Figure:
    """R of every path of the first robots against the moves of the learner."""
    robots = replays.select("log", "robot", "trial").unique(maintain_order=True).head(ROBOTS_SHOWN)
    figure = Figure(figsize=(8.0, 1.2 + 1.8 * robots.height), layout="constrained")
    rows = figure.subplots(robots.height, 1, sharex=True, squeeze=False)
    for place, (log, robot, trial) in enumerate(robots.iter_rows()):
        of_robot = replays.filter((pl.col("log") == log) & (pl.col("robot") == robot)).sort("receive_t_ns")
        _draw_ratios(rows[place][0], of_robot)
        rows[place][0].set_title(f"{robot}, trial {trial}", fontsize=9, loc="left")
    rows[-1][0].set_xlabel("moves made by the learner")
    return figure


def _draw_ratios(axes: Axes, replays: pl.DataFrame) -> None:
    for number, of_path in enumerate(replays.partition_by("path", maintain_order=True)):
        moves, ratios = of_path["started_move"].to_list(), of_path["ratio"].to_list()
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(moves, ratios, color=colour, linewidth=1.0, drawstyle="steps-post")
        axes.annotate(
            f" {of_path['path'][0]}", (moves[-1], ratios[-1]), color=colour, fontsize=7.5, va="center"
        )
    axes.set_ylim(0, 1.03)
    axes.set_ylabel("R")
    _frame(axes)


def _row(figure: Figure, count: int) -> list[Axes]:
    return list(figure.subplots(1, count, squeeze=False)[0])


def _draw_moves(axes: Axes, moves: Sequence[int], colour: str) -> None:
    """A list of moves from a start, in cells: east to the right, south down."""
    columns, rows = [0], [0]
    for move in moves:
        columns.append(columns[-1] + Move(move).columns)
        rows.append(rows[-1] + Move(move).rows)
    axes.plot(columns, rows, color=colour, linewidth=1.8, marker="o", markersize=3)
    axes.plot(0, 0, marker="o", markersize=7, markerfacecolor="white", markeredgecolor=colour)
    side = max(max(columns) - min(columns), max(rows) - min(rows), 5) / 2 + 0.7
    middle_column, middle_row = (max(columns) + min(columns)) / 2, (max(rows) + min(rows)) / 2
    axes.set_xlim(middle_column - side, middle_column + side)
    axes.set_ylim(middle_row + side, middle_row - side)
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(1))
        axis.set_ticklabels([])
    axes.tick_params(length=0)
    axes.grid(color="#ececec", linewidth=0.8)
    _frame(axes)


def _frame(axes: Axes) -> None:
    axes.set_axisbelow(True)
    for spine in axes.spines.values():
        spine.set_color("#cccccc")
