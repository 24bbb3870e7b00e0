"""The picture of many trials."""

from __future__ import annotations

import numpy as np

from swarm.statistics.samples import Curves
from swarm.surrogate.plots import draw_side_by_side


def test_the_legend_hides_no_curve() -> None:
    values = np.random.default_rng(1).uniform(0.0, 100.0, (6, 50))
    times = np.arange(50.0)
    curves = {name: Curves(name, times, values, tuple(range(6))) for name in ("imitation", "no-imitation")}
    figure = draw_side_by_side(curves, curves, "expert", "note")
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert [text.get_text() for text in legend.get_texts()] == ["imitation", "no-imitation"]
    assert not any(axes.get_legend() or axes.get_window_extent().overlaps(box) for axes in figure.axes)
