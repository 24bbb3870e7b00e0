"""What is kept of the observed positions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.imitation.outliers import plausible_trajectory
from robot_agent.imitation.positions import Covariance, ObservedPosition

ROUND: Covariance = ((1e-4, 0.0), (0.0, 1e-4))


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300, -101.0])
def test_impossible_places_are_dropped(bad: float) -> None:
    positions = [ObservedPosition(0, 0.5, 0.5, ROUND), ObservedPosition(1, bad, 0.5, ROUND)]
    assert plausible_trajectory(positions).t_ns.tolist() == [0]


@pytest.mark.parametrize(
    "bad",
    [
        ((math.nan, 0.0), (0.0, 1e-4)),
        ((-1e-4, 0.0), (0.0, 1e-4)),
        ((1e-4, 2e-4), (2e-4, 1e-4)),
        ((1e-4, 1e-5), (0.0, 1e-4)),
        ((math.inf, 0.0), (0.0, math.inf)),
    ],
)
def test_impossible_covariances_are_dropped(bad: Covariance) -> None:
    positions = [ObservedPosition(0, 0.5, 0.5, bad), ObservedPosition(1, 0.5, 0.5, ROUND)]
    assert plausible_trajectory(positions).t_ns.tolist() == [1]


def test_sorted_by_time_and_one_at_a_time() -> None:
    positions = [ObservedPosition(t, float(t), 0.0, ROUND) for t in (3, 1, 2, 3)]
    assert plausible_trajectory(positions).t_ns.tolist() == [1, 2, 3]


def test_a_zero_covariance_becomes_invertible() -> None:
    kept = plausible_trajectory([ObservedPosition(0, 0.0, 0.0, ((0.0, 0.0), (0.0, 0.0)))])
    assert np.linalg.det(kept.covariance_m2[0]) > 0


def test_positions_come_back() -> None:
    positions = (ObservedPosition(5, 0.25, 0.5, ROUND),)
    (back,) = plausible_trajectory(positions).positions()
    assert (back.t_ns, back.x_m, back.y_m) == (5, 0.25, 0.5)


def test_nothing_gives_nothing() -> None:
    assert len(plausible_trajectory([])) == 0
