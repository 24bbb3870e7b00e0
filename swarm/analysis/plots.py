"""The learning curves in the form of the paper's figure 25, for any run."""

from __future__ import annotations

from collections.abc import Collection
from textwrap import fill

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, StrMethodFormatter

from swarm.analysis.learning_curves import RunCurves
from swarm.statistics.intervals import FEWEST
from swarm.statistics.plots import draw_band
from swarm.statistics.samples import Curves

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""Told apart by colour-blind readers too (Okabe and Ito)."""
LINES = ("-", "--", ":", "-.")
"""Where there are more curves than colours."""
GREY = "#595959"
DRAWN_POINTS = 1500
"""More than a picture has pixels for."""
BOLD_POINTS = 300
"""A curve of more is too ragged for a bold line."""
LEGEND_COLUMNS = 3
LEGEND_SIGNS = 96
"""So many names, or so many letters of names, fit the width of the picture."""
NOTE_SIGNS = 118
"""So many letters of the note below fit the width."""
POINT_MOVES = 10
"""A robot finds out its best path every so many moves."""


def plot_curves(found: RunCurves, title: str, paper_axes: bool = False) -> Figure:
    """Mean best path length of each condition against moves, with its 95 % interval as a band.

    With `paper_axes` as in the paper's figures 25 and 26: against data points, of ten moves each.
    """
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    axes.axhline(found.cap, color=GREY, linewidth=0.8, linestyle=(0, (1, 3)))
    for place, curves in enumerate(found.curves.values()):
        _draw(axes, curves, COLOURS[place % len(COLOURS)], LINES[place // len(COLOURS) % len(LINES)])
    _scale(axes, found)
    if paper_axes:
        axes.set_ylim(0, found.cap * 1.04)
        axes.xaxis.set_major_formatter(lambda moves, _: f"{moves / POINT_MOVES:,.0f}")
    _explain(axes, found.curves, title)
    if paper_axes:
        axes.set_xlabel("data points (ten state transitions each)", fontsize=10)
        axes.set_ylabel("best path length", fontsize=10)
    figure.supxlabel(fill(_note(found), NOTE_SIGNS), x=0.01, ha="left", fontsize=8.5, color=GREY)
    return figure


def _draw(axes: Axes, curves: Curves, colour: str, line: str) -> None:
    drawn = curves.every(max(1, len(curves.times) // DRAWN_POINTS))
    draw_band(axes, drawn, colour)
    trials = len(drawn.values)
    label = f"{curves.name}  ({trials} {'trial' if trials == 1 else 'trials'})"
    width = 1.8 if len(drawn.times) <= BOLD_POINTS else 1.0
    axes.plot(
        drawn.times, drawn.values.mean(axis=0), color=colour, linewidth=width, linestyle=line, label=label
    )


def _scale(axes: Axes, found: RunCurves) -> None:
    longest = max(float(curves.values.max()) for curves in found.curves.values())
    axes.set_xlim(0, max(float(curves.times[-1]) for curves in found.curves.values()))
    axes.set_ylim(0, longest * 1.04)
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True, steps=[1, 2, 5, 10]))
    axes.grid(axis="y", color="#e4e4e4", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=9, color=GREY)


def _explain(axes: Axes, conditions: Collection[str], title: str) -> None:
    """Axis labels, and a legend in rows between the title and the curves, where it hides none of them."""
    axes.set_xlabel("moves made by the learner", fontsize=10)
    axes.set_ylabel("best path length (moves)", fontsize=10)
    longest = max(map(len, conditions)) + len("  (100 trials)")
    columns = max(1, min(len(conditions), LEGEND_COLUMNS, LEGEND_SIGNS // longest))
    rows = -(-len(conditions) // columns)
    axes.legend(
        frameon=False,
        fontsize=10,
        ncols=columns,
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.0),
        borderpad=0.2,
    )
    axes.set_title(title, loc="left", fontsize=13, fontweight="bold", pad=10 + 18 * rows)


def _note(found: RunCurves) -> str:
    return f"{interval_note(found)} A path that does not arrive counts as {found.cap} (the cap, dotted)."


def interval_note(found: RunCurves) -> str:
    """What the lines and bands of the picture are."""
    trials = [len(curves.values) for curves in found.curves.values()]
    if max(trials) == 1:
        return "One trial of each condition: no interval can be given."
    if max(trials) < FEWEST:
        return f"Mean over trials, and every trial: of fewer than {FEWEST} no interval can be given."
    exception = f" Of fewer than {FEWEST} trials, every one." if min(trials) < FEWEST else ""
    made = "Student's t on the scale's logit, with a quarter of a trial at each end"
    return f"Mean over trials with its 95 % interval ({made}).{exception}"
