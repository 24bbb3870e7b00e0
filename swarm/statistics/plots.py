"""Curves of replicates on axes: the interval of their mean or, where they are too few, every one of them."""

from __future__ import annotations

from matplotlib.axes import Axes

from swarm.statistics.intervals import FEWEST, interval
from swarm.statistics.samples import Curves

EACH_IS_DRAWN = 5
"""Beside the mean of fewer replicates: their interval is wide, and looking at each says more."""


def draw_band(axes: Axes, curves: Curves, colour: str, opacity: float = 0.2) -> None:
    """The 95 % interval of the mean at every point; of few replicates, each of them too."""
    band = interval(curves)
    if len(curves.values) < EACH_IS_DRAWN:
        draw_each(axes, curves, colour)
    if band is not None:
        axes.fill_between(curves.times, band.low, band.high, color=colour, alpha=opacity, linewidth=0)


def draw_error_bars(axes: Axes, curves: Curves, colour: str, first: int, every: int) -> None:
    """The 95 % interval of the mean at some points; of few replicates, each of them too."""
    band = interval(curves)
    if len(curves.values) < EACH_IS_DRAWN:
        draw_each(axes, curves, colour)
    if band is None:
        return
    shown = slice(first, None, every)
    axes.errorbar(
        curves.times[shown],
        band.centre[shown],
        yerr=band.errors[:, shown],
        color=colour,
        fmt="none",
        elinewidth=0.7,
        capsize=1.5,
    )


def draw_each(axes: Axes, curves: Curves, colour: str) -> None:
    """A thin line for each replicate; a single one is its own mean."""
    if len(curves.values) > 1:
        axes.plot(curves.times, curves.values.T, color=colour, linewidth=0.6, alpha=0.5)


def interval_words(replicates: int, name: str) -> str:
    """What is drawn beside the mean of so many: "100 runs: mean and 95 % interval"."""
    if replicates == 1:
        return f"1 {name}, no interval"
    shown = ["95 % interval"] if replicates >= FEWEST else []
    shown += [f"every {name}"] if replicates < EACH_IS_DRAWN else []
    return f"{replicates} {name}s: mean, {' and '.join(shown)}"
