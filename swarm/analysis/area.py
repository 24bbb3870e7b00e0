"""The area under a learning curve: how much was lost while learning, in one number a replicate."""

from __future__ import annotations

import numpy as np

from swarm.analysis.curves import Curves, Sample


def area_under_curve(curves: Curves) -> Sample:
    """The trapezoidal area of each replicate, in the curve's unit times the unit of time."""
    area = np.asarray(np.trapezoid(curves.values, curves.times, axis=1))
    return Sample(curves.name, area, curves.replicates)


def mean_level(curves: Curves) -> Sample:
    """The mean over the curve's points of each replicate: the height of its area, in the curve's unit."""
    return Sample(curves.name, curves.values.mean(axis=1), curves.replicates)
