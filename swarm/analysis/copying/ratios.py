"""R of every path over time: what becomes of copies, good and bad."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, StrMethodFormatter
from scipy.optimize import isotonic_regression

from swarm.analysis.copying.paths import FIRST_R, OF_PATH, LoggedPath
from swarm.analysis.plots import GREY
from swarm.statistics.samples import FloatArray

ROBOTS_SHOWN = 4
LABEL_APART = 0.062
"""Of the axis's height: labels closer than that would overlap."""
TOP = 1.04


@dataclass(frozen=True)
class RatioLine:
    """R of a path: (times,) numbers of the robot's moves, and the R that held from then on."""

    path: LoggedPath
    moves: list[int]
    ratios: list[float]


def ratio_lines(paths: Sequence[LoggedPath], replays: pl.DataFrame) -> list[RatioLine]:
    """R from the moment when a path was remembered until the robot's last move."""
    ordered = replays.sort("receive_t_ns", maintain_order=True)
    by_path = ordered.partition_by(OF_PATH, maintain_order=True, as_dict=True)
    return [_line(path, by_path.get((path.log, path.robot, path.path))) for path in paths]


def _line(path: LoggedPath, replays: pl.DataFrame | None) -> RatioLine:
    moves, ratios = [path.known_from], [FIRST_R]
    if replays is not None:
        moves += (replays["started_move"] + replays["moves"] - 1).to_list()
        ratios += replays["ratio"].to_list()
    moves.append(max(moves[-1], path.known_from + path.known_for))
    return RatioLine(path, moves, [*ratios, ratios[-1]])


def apart(heights: Sequence[float], least: float, top: float) -> FloatArray:
    """Heights for labels: in the same order of size, at least `least` apart, at most `top`, least moved."""
    wanted = np.asarray(heights, dtype=float)
    order = np.argsort(wanted, kind="stable")
    steps = least * np.arange(len(wanted))
    spread = isotonic_regression(wanted[order] - steps).x + steps
    found = np.empty_like(wanted)
    found[order] = np.minimum(spread, top - steps[::-1])
    return found


def plot_ratios(
    paths: Sequence[LoggedPath], replays: pl.DataFrame, colour_of: Callable[[LoggedPath], str]
) -> Figure:
    """A row for each of the first robots, a line for each of its paths, labelled at its end."""
    lines = ratio_lines(paths, replays)
    robots = sorted({_learner(line) for line in lines})
    shown = robots[:ROBOTS_SHOWN]
    figure = Figure(figsize=(8.0, 1.6 + 2.2 * len(shown)), layout="constrained")
    figure.suptitle("R of every path while learning", fontsize=13, fontweight="bold", x=0.01, ha="left")
    rows = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axes, robot in zip(rows, shown, strict=True):
        _draw(axes, [line for line in lines if _learner(line) == robot], colour_of)
    rows[-1].set_xlabel("moves made by the learner", fontsize=10)
    figure.supxlabel(_note(len(robots)), x=0.01, ha="left", fontsize=8.5, color=GREY)
    return figure


def _learner(line: RatioLine) -> tuple[int, int, str, str]:
    path = line.path
    return path.seed, path.trial, path.robot, path.log


def _note(robots: int) -> str:
    text = "Numbers: the path. Blue: a perfect copy; orange: a wrong one; grey: given, or not judged."
    return text if robots <= ROBOTS_SHOWN else f"{text} The first {ROBOTS_SHOWN} of {robots} learners."


def _draw(axes: Axes, lines: Sequence[RatioLine], colour_of: Callable[[LoggedPath], str]) -> None:
    labels = apart([line.ratios[-1] for line in lines], LABEL_APART * TOP, TOP - 0.02)
    end = max(1, *(line.moves[-1] for line in lines))
    for line, height in zip(lines, labels, strict=True):
        colour = colour_of(line.path)
        axes.step(line.moves, line.ratios, where="post", color=colour, linewidth=1.1, alpha=0.75)
        text = f"{line.path.path}"
        axes.annotate(text, (line.moves[-1], line.ratios[-1]), (end * 1.025, height), **_label(colour))
    first = lines[0].path
    axes.set_title(f"{first.robot}, trial {first.trial}", fontsize=10, loc="left", color=GREY)
    _scale(axes, end)


def _label(colour: str) -> dict[str, Any]:
    leader = {"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 0, "alpha": 0.6}
    return {"color": colour, "fontsize": 9, "va": "center", "annotation_clip": False, "arrowprops": leader}


def _scale(axes: Axes, end: int) -> None:
    axes.set_xlim(0, end)
    axes.set_ylim(0, TOP)
    axes.set_ylabel("R", fontsize=10, rotation=0, labelpad=8)
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, steps=[1, 2, 2.5, 5, 10]))
    axes.grid(axis="y", color="#e4e4e4", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9, color=GREY)
