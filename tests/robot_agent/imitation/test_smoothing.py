"""The Rauch-Tung-Striebel smoother."""

from __future__ import annotations

import numpy as np
import pytest

from robot_agent.imitation.smoothing import ACCELERATION_NOISE_M2_S3, FIRST_SPEED_SD_M_S, smooth
from robot_agent.imitation.trajectory import Floats, Trajectory


def trajectory(xy_m: Floats, sd_m: float, period_s: float = 0.2) -> Trajectory:
    t_ns = (np.arange(len(xy_m)) * period_s * 1e9).astype(np.int64)
    return Trajectory(t_ns, xy_m, np.tile(sd_m**2 * np.eye(2), (len(xy_m), 1, 1)))


def test_equals_the_batch_least_squares_solution() -> None:
    """The smoother is the posterior mean of one large linear-Gaussian model; here it is solved at once."""
    xy_m = np.random.default_rng(1).normal(0.0, 0.02, (12, 2)).cumsum(axis=0)
    sd_m, dt_s = 0.03, 0.2
    information, right = np.zeros((24, 24)), np.zeros(24)
    information[1, 1] += FIRST_SPEED_SD_M_S**-2
    step = np.array([[-1, -dt_s, 1, 0], [0, -1, 0, 1]])
    noise = ACCELERATION_NOISE_M2_S3 * np.array([[dt_s**3 / 3, dt_s**2 / 2], [dt_s**2 / 2, dt_s]])
    for i in range(12):
        information[2 * i, 2 * i] += sd_m**-2
        right[2 * i] += xy_m[i, 0] / sd_m**2
    for i in range(11):
        block = slice(2 * i, 2 * i + 4)
        information[block, block] += step.T @ np.linalg.inv(noise) @ step
    expected = np.linalg.solve(information, right)
    found = smooth(trajectory(xy_m, sd_m))
    assert found.xy_m[:, 0] == pytest.approx(expected[0::2], abs=1e-9)
    assert found.velocity_m_s[:, 0] == pytest.approx(expected[1::2], abs=1e-8)
    variances = np.diag(np.linalg.inv(information))
    assert found.covariance_m2[:, 0, 0] == pytest.approx(variances[0::2])


def test_halves_the_error_of_a_standing_robot() -> None:
    noise_m = np.random.default_rng(5).normal(0.0, 0.03, (60, 2))
    smoothed = smooth(trajectory(noise_m, 0.03))
    assert smoothed.xy_m.std() < noise_m.std() / 2
    assert np.median(smoothed.speed_m_s) < 0.03


def test_passes_over_what_is_outside_the_gate() -> None:
    xy_m = np.column_stack((0.02 * np.arange(20), np.zeros(20)))
    wrong = xy_m.copy()
    wrong[10] += (0.0, 0.8)
    smoothed = smooth(trajectory(wrong, 0.005))
    assert smoothed.xy_m[10] == pytest.approx(xy_m[10], abs=0.01)


def test_one_position_is_its_own_estimate() -> None:
    smoothed = smooth(trajectory(np.array([[0.3, 0.4]]), 0.01))
    assert smoothed.xy_m.tolist() == [[0.3, 0.4]]
