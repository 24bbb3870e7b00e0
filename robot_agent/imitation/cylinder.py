"""From the two side edges of a robot's skirt to where the robot is.

The skirt is an upright cylinder around the robot's axis. Its silhouette in the camera's horizontal
plane is two tangents; the angle between them tells the range, their middle the bearing, exactly and
anywhere in the view. (width = f w / d holds on the camera's axis only.)
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

SKIRT_RADIUS_M = 0.0355
SKIRT_BOTTOM_M = 0.004
SKIRT_TOP_M = 0.042


def range_and_bearing(
    left_rad: float, right_rad: float, radius_m: float = SKIRT_RADIUS_M
) -> tuple[float, float]:
    """(range to the cylinder's axis in metres, bearing of the axis) from the bearings of its two edges."""
    half_rad = (left_rad - right_rad) / 2
    return radius_m / math.sin(half_rad), (left_rad + right_rad) / 2


def half_angle_rad(range_m: float, radius_m: float = SKIRT_RADIUS_M) -> float:
    """Half the angle that the cylinder fills at a range, seen from the camera."""
    return math.asin(min(1.0, radius_m / range_m))


def covariance(range_m: float, edge_sd_rad: float, bearing_sd_rad: float) -> NDArray[np.float64]:
    """2 x 2 covariance of (range, bearing), metres and radians.

    From d = R / sin(half): an edge error of s turns into a range error of s d^2 / (R sqrt 2), so the
    standard deviation grows as k d^2. `bearing_sd_rad` is what the mounting adds to the bearing alone.
    """
    range_sd_m = edge_sd_rad / math.sqrt(2) * range_m**2 / SKIRT_RADIUS_M
    return np.diag([range_sd_m**2, edge_sd_rad**2 / 2 + bearing_sd_rad**2])
