"""The median gate."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.outliers import without_outliers
from robot_agent.imitation.trajectory import Floats, Trajectory

FRAMES = 30


def trajectory(xy_m: Floats) -> Trajectory:
    t_ns = np.arange(len(xy_m), dtype=np.int64) * 200_000_000
    return Trajectory(t_ns, xy_m, np.tile(1e-4 * np.eye(2), (len(xy_m), 1, 1)))


def driving() -> Floats:
    return np.column_stack((0.1 + 0.02 * np.arange(FRAMES), np.full(FRAMES, 0.5)))


def test_a_driving_robot_passes() -> None:
    noise_m = np.random.default_rng(2).normal(0, 0.01, (FRAMES, 2))
    assert len(without_outliers(trajectory(driving() + noise_m))) == FRAMES


def test_single_and_double_outliers_are_found_at_the_ends_too() -> None:
    for wrong in ([0], [13], [14, 15], [FRAMES - 1]):
        xy_m = driving()
        xy_m[wrong] += 0.4
        kept = without_outliers(trajectory(xy_m))
        assert sorted({*range(FRAMES)} - {*(kept.t_ns // 200_000_000).tolist()}) == wrong


def test_too_few_to_judge() -> None:
    xy_m = np.array([[0.0, 0.0], [1.0, 1.0]])
    assert len(without_outliers(trajectory(xy_m))) == 2
