"""Figures 25 and 26 twice: four trials as in the paper, and all trials with the interval of their mean."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from swarm.analysis.plots import COLOURS, DRAWN_POINTS
from swarm.files import write_png
from swarm.statistics.intervals import FEWEST
from swarm.statistics.plots import draw_band, draw_error_bars, interval_words
from swarm.statistics.samples import Curves

ERROR_BARS = 15
"""A curve: none hides another, and those of the conditions stand beside each other."""


def draw_side_by_side(
    paper: dict[str, Curves], family_wise: dict[str, Curves], title: str, note: str
) -> Figure:
    """Left the paper's picture (lines with error bars), right all trials (lines with bands)."""
    figure = Figure(figsize=(12.0, 5.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    for place, (name, curves) in enumerate(paper.items()):
        _draw_error_bars(left, name, curves, COLOURS[place], place)
    for place, (name, curves) in enumerate(family_wise.items()):
        _draw_band(right, name, curves, COLOURS[place])
    left.set_title(f"few, as in the paper: {_trials(paper)}", fontsize=11)
    right.set_title(_trials(family_wise) + _quartiles(family_wise), fontsize=11)
    for axes in (left, right):
        axes.set_xlabel("moves made by the learner")
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
        axes.grid(alpha=0.25)
    left.set_ylabel("best path length (moves)")
    left.set_ylim(bottom=0)
    figure.suptitle(title, fontweight="bold")
    # Beside the title: curves and bands leave no free place within the axes.
    figure.legend(
        *left.get_legend_handles_labels(), loc="outside upper right", frameon=False, ncols=len(paper)
    )
    figure.supxlabel(note, x=0.01, ha="left", fontsize=8.5)
    return figure


def first_trials(curves: dict[str, Curves], count: int) -> dict[str, Curves]:
    """The first few trials of each condition."""
    return {
        name: replace(each, values=each.values[:count], replicates=each.replicates[:count])
        for name, each in curves.items()
    }


def write_picture(
    paper: dict[str, Curves], family_wise: dict[str, Curves], title: str, note: str, path: Path
) -> None:
    write_png(draw_side_by_side(paper, family_wise, title, note), path)


def _drawn(curves: Curves) -> Curves:
    return curves.every(max(1, len(curves.times) // DRAWN_POINTS))


def _draw_error_bars(axes: Axes, name: str, curves: Curves, colour: str, place: int) -> None:
    drawn = _drawn(curves)
    axes.plot(drawn.times, drawn.values.mean(axis=0), color=colour, linewidth=1.2, label=name)
    draw_error_bars(axes, drawn, colour, place * 3, max(1, len(drawn.times) // ERROR_BARS))


def _draw_band(axes: Axes, name: str, curves: Curves, colour: str) -> None:
    drawn = _drawn(curves)
    axes.plot(drawn.times, drawn.values.mean(axis=0), color=colour, linewidth=1.6, label=name)
    draw_band(axes, drawn, colour, opacity=0.35)
    if len(drawn.values) >= FEWEST:
        low, high = np.quantile(drawn.values, [0.25, 0.75], axis=0)
        axes.fill_between(drawn.times, low, high, color=colour, alpha=0.10, linewidth=0)


def _trials(curves: dict[str, Curves]) -> str:
    return interval_words(_fewest(curves), "trial")


def _quartiles(curves: dict[str, Curves]) -> str:
    return ", and the middle half" if _fewest(curves) >= FEWEST else ""


def _fewest(curves: dict[str, Curves]) -> int:
    return min(len(each.values) for each in curves.values())
