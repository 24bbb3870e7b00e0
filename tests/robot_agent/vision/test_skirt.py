"""The geometry of a skirt's silhouette."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.vision.demonstrator import SKIRT_RADIUS_M
from robot_agent.vision.skirt import (
    covariance,
    covariance_of_one_edge,
    half_angle_rad,
    range_and_bearing,
)


@pytest.mark.parametrize("range_m", [0.1, 0.4, 1.5])
@pytest.mark.parametrize("bearing_deg", [-24.0, 0.0, 17.0])
def test_the_tangents_give_range_and_bearing_anywhere_in_view(range_m: float, bearing_deg: float) -> None:
    bearing_rad, half_rad = math.radians(bearing_deg), half_angle_rad(range_m)
    found = range_and_bearing(bearing_rad + half_rad, bearing_rad - half_rad)
    assert found == pytest.approx((range_m, bearing_rad))


def test_the_covariance_is_that_of_random_edges() -> None:
    rng = np.random.default_rng(1)
    range_m, sd_rad = 0.9, 4e-4
    edges = rng.normal([half_angle_rad(range_m), -half_angle_rad(range_m)], sd_rad, (20_000, 2))
    found = np.cov(np.array([range_and_bearing(left, right) for left, right in edges]).T)
    said = np.array(covariance(range_m, sd_rad, 0.0))
    assert np.sqrt(np.diag(said)) == pytest.approx(np.sqrt(np.diag(found)), rel=0.03)


@pytest.mark.parametrize("side", [1, -1])
def test_with_one_edge_range_and_bearing_err_together(side: int) -> None:
    rng = np.random.default_rng(2)
    range_m, range_sd_m, sd_rad = 0.4, 0.01, 4e-4
    ranges = rng.normal(range_m, range_sd_m, 20_000)
    edges = side * half_angle_rad(range_m) + rng.normal(0, sd_rad, ranges.size)
    found = np.cov(ranges, edges - side * np.arcsin(SKIRT_RADIUS_M / ranges))
    said = np.array(covariance_of_one_edge(range_m, range_sd_m, sd_rad, 0.0, side))
    assert np.sqrt(np.diag(said)) == pytest.approx(np.sqrt(np.diag(found)), rel=0.03)
    assert said[0, 1] == pytest.approx(found[0, 1], rel=0.05)
