"""The median gate."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.positions import Floats, Trajectory, inliers

FRAMES = 30


def trajectory(xy_m: Floats) -> Trajectory:
    t_ns = np.arange(len(xy_m), dtype=np.int64) * 200_000_000
    return Trajectory(t_ns, xy_m, np.tile(1e-4 * np.eye(2), (len(xy_m), 1, 1)))


def driving() -> Floats:
    return np.column_stack((0.1 + 0.02 * np.arange(FRAMES), np.full(FRAMES, 0.5)))


def test_a_driving_robot_passes() -> None:
    noise_m = np.random.default_rng(2).normal(0, 0.01, (FRAMES, 2))
    assert inliers(trajectory(driving() + noise_m)).all()


def test_single_and_double_outliers_are_found_at_the_ends_too() -> None:
    for wrong in ([0], [13], [14, 15], [FRAMES - 1]):
        xy_m = driving()
        xy_m[wrong] += 0.4
        assert np.flatnonzero(~inliers(trajectory(xy_m))).tolist() == wrong


def test_too_few_to_judge() -> None:
    xy_m = np.array([[0.0, 0.0], [1.0, 1.0]])
    assert inliers(trajectory(xy_m)).all()
