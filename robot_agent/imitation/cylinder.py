"""From the two side edges of a robot's skirt to where the robot is.

The skirt is an upright cylinder around the robot's axis. Its silhouette in the camera's horizontal
plane is two tangents; the angle between them tells the range, their middle the bearing, exactly and
anywhere in the view. (width = f w / d holds on the camera's axis only.)
"""

from __future__ import annotations

import math
from typing import TypeAlias

Covariance: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Of (range, bearing), in metres and radians."""

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


def covariance(range_m: float, edge_sd_rad: float, mounting_sd_rad: float) -> Covariance:
    """Of (range, bearing) when both edges are seen, each with its own independent error.

    From d = R / sin(half): the range's standard deviation is d^2 `edge_sd_rad` / (R sqrt 2).
    `mounting_sd_rad` is what the camera's place on the robot adds to the bearing.
    """
    range_sd_m = edge_sd_rad / math.sqrt(2) * range_m**2 / SKIRT_RADIUS_M
    return (range_sd_m**2, 0.0), (0.0, edge_sd_rad**2 / 2 + mounting_sd_rad**2)


def covariance_of_one_edge(
    range_m: float, range_sd_m: float, edge_sd_rad: float, mounting_sd_rad: float, side: int
) -> Covariance:
    """Of (range, bearing) when one edge (`side` 1: left, -1: right) is seen and the height gives the range.

    The bearing is the edge's less `side` times asin(R / d): a robot thought too far is also thought too
    close to that edge.
    """
    swing = side * SKIRT_RADIUS_M / range_m**2
    bearing_variance = edge_sd_rad**2 + (swing * range_sd_m) ** 2 + mounting_sd_rad**2
    shared = swing * range_sd_m**2
    return (range_sd_m**2, shared), (shared, bearing_variance)
