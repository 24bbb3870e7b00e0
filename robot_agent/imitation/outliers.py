"""Positions that no robot could produce are left out of a trajectory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.positions import ObservedPosition
from robot_agent.imitation.trajectory import CHI2_GATE, Floats, Trajectory, chi2

FARTHEST_M = 100.0
"""No laboratory is larger: beyond it a coordinate is a fault."""
LEAST_SD_M = 1e-4
"""No camera is better: keeps every covariance invertible."""
WINDOW = 5
"""Positions of the median: it bears two outliers in a row, and at 5 frames a second spans 0.8 s."""
ROBOT_SPEED_M_S = 0.13
"""What a robot can really have moved from the median's time; the e-puck's wheels allow no more."""


def plausible_trajectory(positions: Sequence[ObservedPosition]) -> Trajectory:
    """Sort by time; drop NaN, far away places, bad covariances, and a second position at the same time."""
    every = Trajectory(
        np.array([position.t_ns for position in positions], dtype=np.int64),
        np.array([(p.x_m, p.y_m) for p in positions], dtype=np.float64).reshape(-1, 2),
        np.array([p.covariance for p in positions], dtype=np.float64).reshape(-1, 2, 2),
    )
    sound = every.where(_sound_places(every.xy_m) & _sound_covariances(every.covariance_m2))
    _, first = np.unique(sound.t_ns, return_index=True)
    kept = Trajectory(sound.t_ns[first], sound.xy_m[first], sound.covariance_m2[first])
    return Trajectory(kept.t_ns, kept.xy_m, kept.covariance_m2 + LEAST_SD_M**2 * np.eye(2))


def _sound_places(xy_m: Floats) -> NDArray[np.bool_]:
    return np.asarray((np.abs(xy_m) <= FARTHEST_M).all(axis=1), dtype=np.bool_)


def _sound_covariances(covariance_m2: Floats) -> NDArray[np.bool_]:
    """Finite, symmetric and not negative; NaN compares false."""
    xx, xy, yx, yy = covariance_m2.reshape(-1, 4).T
    with np.errstate(invalid="ignore", over="ignore"):
        finite = (np.abs(covariance_m2) <= FARTHEST_M**2).all(axis=(1, 2))
        proper = (xx >= 0) & (yy >= 0) & (np.abs(xy - yx) <= 1e-9) & (xy * yx <= xx * yy * (1 + 1e-9))
    sound: NDArray[np.bool_] = finite & proper
    return sound


def without_outliers(trajectory: Trajectory) -> Trajectory:
    """Only positions within the gate around the median of the five positions around them."""
    if len(trajectory) < 3:
        return trajectory
    medians_m, spans_s = _medians(trajectory)
    moved_m2 = (ROBOT_SPEED_M_S * spans_s) ** 2
    covariance_m2 = trajectory.covariance_m2 + moved_m2[:, None, None] * np.eye(2)
    distances = chi2(trajectory.xy_m - medians_m, covariance_m2)
    return trajectory.where(distances <= CHI2_GATE)


def _medians(trajectory: Trajectory) -> tuple[Floats, Floats]:
    """Of the window around each position: the median place and half the time it spans."""
    half = WINDOW // 2
    first = np.clip(np.arange(len(trajectory)) - half, 0, max(len(trajectory) - WINDOW, 0))
    window = np.minimum(first[:, None] + np.arange(WINDOW), len(trajectory) - 1)
    t_s = trajectory.t_s[window]
    return np.median(trajectory.xy_m[window], axis=1), (t_s[:, -1] - t_s[:, 0]) / 2
