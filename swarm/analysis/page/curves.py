"""The learning curves of a page: mean, interval, and every trial, at each point."""

from __future__ import annotations

from typing import Any

import numpy as np

from swarm.analysis.page.sources import Sources
from swarm.analysis.plots import COLOURS
from swarm.analysis.summary import Summary
from swarm.messages import topics
from swarm.statistics.intervals import interval
from swarm.statistics.samples import Curves, FloatArray

MOST_POINTS = 1500
"""Of a curve: as many as the paper's have, and more than a screen has pixels for."""
MOST_TRIALS = 30
"""Of a condition are drawn one by one; more make a grey field."""
DIGITS = 6
"""Significant ones: a curve of means is not known better, and the file stays small."""


def page_curves(summary: Summary, sources: Sources) -> list[dict[str, Any]]:
    """A curve for each condition, in the colour of the figures."""
    return [
        _curve(curves, COLOURS[place % len(COLOURS)], sources)
        for place, curves in enumerate(summary.curves.curves.values())
    ]


def _curve(curves: Curves, colour: str, sources: Sources) -> dict[str, Any]:
    shown = curves.every(max(1, -(-len(curves.times) // MOST_POINTS)))
    band = interval(shown)
    keys = sources.keys_of_condition(curves.name, topics.BEST_PATH)
    how = "mean over trials of the best path's length at this move, with its 95 % interval"
    trials = zip(shown.replicates, shown.values, strict=True)
    return {
        "name": curves.name,
        "colour": colour,
        "moves": [int(move) for move in shown.times],
        "mean": rounded(shown.values.mean(axis=0)),
        "low": None if band is None else rounded(band.low),
        "high": None if band is None else rounded(band.high),
        "trials": [
            {"of": list(replicate), "lengths": rounded(values)}  # type: ignore[call-overload]
            for replicate, values in list(trials)[:MOST_TRIALS]
        ],
        "count": len(shown.values),
        "source": sources.of(sources.of_condition(curves.name), keys, how),
    }


def rounded(values: FloatArray) -> list[float]:
    """Plain numbers; whole ones without a point, which makes them shorter."""
    found = [float(f"{value:.{DIGITS}g}") for value in np.asarray(values).tolist()]
    return [int(value) if value.is_integer() else value for value in found]
