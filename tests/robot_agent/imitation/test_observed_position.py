"""A detection's position and covariance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.imitation.positions import position_from_detection
from swarm.geometry import Pose


def test_straight_ahead_in_every_direction() -> None:
    for degrees in (0, 45, 90, 135, 180, -90):
        theta_rad = math.radians(degrees)
        seen = position_from_detection(Pose(1.0, 2.0, theta_rad), 0.03, 0.5, 0.0, 0.02, 0.004, 7)
        assert seen.x_m == pytest.approx(1.0 + 0.53 * math.cos(theta_rad))
        assert seen.y_m == pytest.approx(2.0 + 0.53 * math.sin(theta_rad))
        assert seen.t_ns == 7


def test_bearing_is_to_the_left_of_the_camera() -> None:
    seen = position_from_detection(Pose(0.0, 0.0, 0.0), 0.03, 1.0, math.pi / 2, 0.01, 0.004, 0)
    assert (seen.x_m, seen.y_m) == pytest.approx((0.03, 1.0))


def test_covariance_is_long_in_range_and_narrow_across() -> None:
    seen = position_from_detection(
        Pose(0.0, 0.0, 0.3), 0.0, 2.0, 0.2, 0.05, 0.003, 0, own_heading_sd_rad=0.004
    )
    variances_m2, axes = np.linalg.eigh(np.array(seen.covariance))
    assert np.sqrt(variances_m2) == pytest.approx([2.0 * 0.005, 0.05])
    assert abs(axes[:, 1] @ [math.cos(0.5), math.sin(0.5)]) == pytest.approx(1.0)


def test_covariance_is_that_of_noisy_sightings() -> None:
    rng = np.random.default_rng(4)
    pose, range_m, bearing_rad = Pose(1.16, 0.04, 2.2), 0.9, 0.1

    def noisy() -> tuple[float, float]:
        heading_rad = pose.theta_rad + rng.normal(0, 0.005)
        seen = position_from_detection(
            Pose(pose.x_m, pose.y_m, heading_rad),
            0.03,
            range_m + rng.normal(0, 0.02),
            bearing_rad + rng.normal(0, 0.004),
            0.02,
            0.004,
            0,
        )
        return seen.x_m, seen.y_m

    told = position_from_detection(pose, 0.03, range_m, bearing_rad, 0.02, 0.004, 0, own_heading_sd_rad=0.005)
    found = np.cov(np.array([noisy() for _ in range(4000)]).T)
    assert found == pytest.approx(np.array(told.covariance), abs=3e-5)
