"""Runs of the engine, made up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from swarm.gridworld.simulation import Trace


def made_up_trace(lengths: NDArray[np.int32], ratios: NDArray[np.float64], steps: int) -> Trace:
    """A trace of these best paths (learners, points) and R values (learners, paths)."""
    learners, paths = ratios.shape
    replicated, tally = np.zeros((learners, paths), np.int64), np.zeros((learners, 4), np.int64)
    return Trace(lengths, ratios, steps, replicated, tally, np.zeros(learners))
