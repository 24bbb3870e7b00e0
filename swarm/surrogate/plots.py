"""Figures 25 and 26 twice: four trials as in the paper, and all trials with the interval of their mean."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from swarm.analysis.plots import COLOURS, DRAWN_POINTS, save_png
from swarm.statistics.intervals import pointwise_t_band
from swarm.statistics.samples import Curves

ERROR_BARS = 15


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
    left.set_title(f"as in the paper: {_trials(paper)}, mean and 95 % intervals", fontsize=11)
    right.set_title(f"{_trials(family_wise)}, mean, its 95 % interval, and the middle half", fontsize=11)
    for axes in (left, right):
        axes.set_xlabel("moves made by the learner")
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
        axes.grid(alpha=0.25)
        axes.legend(frameon=False)
    left.set_ylabel("best path length (moves)")
    left.set_ylim(bottom=0)
    figure.suptitle(title, fontweight="bold")
    figure.supxlabel(note, x=0.01, ha="left", fontsize=8.5)
    return figure


def first_trials(curves: dict[str, Curves], count: int) -> dict[str, Curves]:
    """The first few trials of each condition."""
    return {
        name: Curves(each.name, each.times, each.values[:count], each.replicates[:count])
        for name, each in curves.items()
    }


def write_picture(
    paper: dict[str, Curves], family_wise: dict[str, Curves], title: str, note: str, path: Path
) -> None:
    save_png(draw_side_by_side(paper, family_wise, title, note), path)


def _drawn(curves: Curves) -> Curves:
    return curves.every(max(1, len(curves.times) // DRAWN_POINTS))


def _draw_error_bars(axes: Axes, name: str, curves: Curves, colour: str, place: int) -> None:
    drawn = _drawn(curves)
    mean = drawn.values.mean(axis=0)
    axes.plot(drawn.times, mean, color=colour, linewidth=1.2, label=name)
    if len(drawn.values) > 1:
        band = pointwise_t_band(drawn.values)
        shown = slice(place * 3, None, max(1, len(drawn.times) // ERROR_BARS))
        half = (band.high - band.centre)[shown]
        axes.errorbar(
            drawn.times[shown], mean[shown], yerr=half, color=colour, fmt="none", elinewidth=0.8, capsize=2
        )


def _draw_band(axes: Axes, name: str, curves: Curves, colour: str) -> None:
    drawn = _drawn(curves)
    axes.plot(drawn.times, drawn.values.mean(axis=0), color=colour, linewidth=1.6, label=name)
    if len(drawn.values) > 1:
        band = pointwise_t_band(drawn.values)
        axes.fill_between(drawn.times, band.low, band.high, color=colour, alpha=0.35, linewidth=0)
        low, high = np.quantile(drawn.values, [0.25, 0.75], axis=0)
        axes.fill_between(drawn.times, low, high, color=colour, alpha=0.10, linewidth=0)


def _trials(curves: dict[str, Curves]) -> str:
    count = min(len(each.values) for each in curves.values())
    return "1 trial" if count == 1 else f"{count} trials"
