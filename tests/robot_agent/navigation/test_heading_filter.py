"""The heading filter's gains are those of the matrix form, and it learns the wheels' sizes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.navigation.heading_filter import HeadingFilter, HeadingSettings

TRACK_M = 0.053


class MatrixFilter:
    """The textbook Kalman filter of (heading, left scale, right scale)."""

    def __init__(self, settings: HeadingSettings) -> None:
        self.settings = settings
        self.covariance = np.diag([settings.tracker_sd_rad**2, settings.scale_sd**2, settings.scale_sd**2])

    def predict(self, left_m: float, right_m: float) -> None:
        transition = np.eye(3)
        transition[0, 1:] = -left_m / TRACK_M, right_m / TRACK_M
        rolled_m = 0.5 * (abs(left_m) + abs(right_m))
        drift = self.settings.scale_drift_sd_per_sqrt_m**2
        noise = np.diag([self.settings.slip_sd_rad_per_sqrt_m**2, drift, drift]) * rolled_m
        self.covariance = transition @ self.covariance @ transition.T + noise

    def update(self, left_since_m: float, right_since_m: float) -> np.ndarray:
        self.covariance[0, 0] = max(self.covariance[0, 0], self.settings.smallest_sd_rad**2)
        measured = np.array([1.0, left_since_m / TRACK_M, -right_since_m / TRACK_M])
        variance = measured @ self.covariance @ measured + self.settings.tracker_sd_rad**2
        gains: np.ndarray = self.covariance @ measured / variance
        self.covariance = (np.eye(3) - np.outer(gains, measured)) @ self.covariance
        return gains


def test_gains_are_those_of_the_matrix_form() -> None:
    rng = np.random.default_rng(4)
    scalar, matrix = HeadingFilter(HeadingSettings(), TRACK_M), MatrixFilter(HeadingSettings())
    for _ in range(300):
        for left_m, right_m in rng.uniform(-0.01, 0.012, (int(rng.integers(1, 4)), 2)).tolist():
            scalar.predict(left_m, right_m)
            matrix.predict(left_m, right_m)
        assert scalar.update(left_m, right_m) == pytest.approx(matrix.update(left_m, right_m), rel=1e-6)


def test_learns_the_sizes_of_the_wheels() -> None:
    rng = np.random.default_rng(5)
    learning = HeadingFilter(HeadingSettings(), TRACK_M)
    true, learned, error_rad = (1.012, 0.991), [1.0, 1.0], 0.0
    for tick in range(1500):
        left_m, right_m = (0.01, 0.01) if tick % 40 < 20 else (-0.008, 0.008)
        error_rad += ((right_m * (true[1] - learned[1])) - (left_m * (true[0] - learned[0]))) / TRACK_M
        learning.predict(left_m, right_m)
        heading, left, right = learning.update(0.0, 0.0)
        surprise_rad = error_rad + rng.normal(0.0, math.radians(1.0))
        error_rad -= heading * surprise_rad
        learned[0] += left * surprise_rad
        learned[1] += right * surprise_rad
    assert learned == pytest.approx(list(true), abs=0.004)


def test_a_standing_robot_goes_on_listening() -> None:
    standing = HeadingFilter(HeadingSettings(), TRACK_M)
    gains = [standing.update(0.0, 0.0)[0] for _ in range(500)]
    assert gains[0] == pytest.approx(0.5)
    assert gains[-1] == pytest.approx(0.05, abs=0.01)
