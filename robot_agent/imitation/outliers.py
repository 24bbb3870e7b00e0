"""The median gate: a position that its neighbours contradict is dropped before it can bend the smoothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.sightings import Floats, Sightings

WINDOW = 5
CHI2_GATE = 25.0
ROBOT_SPEED_M_S = 0.13
"""What a robot can really have moved from the median's time; the e-puck's wheels allow no more."""


def inliers(sightings: Sightings) -> NDArray[np.bool_]:
    """Which positions lie within the gate around the median of the five positions around them."""
    if len(sightings) < 3:
        return np.ones(len(sightings), dtype=np.bool_)
    medians_m, spans_s = _medians(sightings)
    moved_m2 = (ROBOT_SPEED_M_S * spans_s) ** 2
    covariance_m2 = sightings.covariance_m2 + moved_m2[:, None, None] * np.eye(2)
    distances = chi2(sightings.xy_m - medians_m, covariance_m2)
    inside: NDArray[np.bool_] = distances <= CHI2_GATE
    return inside


def chi2(difference_m: Floats, covariance_m2: Floats) -> Floats:
    """Squared Mahalanobis lengths of differences [N, 2] under covariances [N, 2, 2]."""
    (xx, xy), (_, yy) = covariance_m2[:, 0].T, covariance_m2[:, 1].T
    x, y = difference_m.T
    result: Floats = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    return result


def _medians(sightings: Sightings) -> tuple[Floats, Floats]:
    """Of the window around each position: the median place and half the time it spans."""
    half = WINDOW // 2
    first = np.clip(np.arange(len(sightings)) - half, 0, max(len(sightings) - WINDOW, 0))
    window = np.minimum(first[:, None] + np.arange(WINDOW), len(sightings) - 1)
    t_s = sightings.t_s[window]
    return np.median(sightings.xy_m[window], axis=1), (t_s[:, -1] - t_s[:, 0]) / 2
