"""A skirt as a cylinder: whether a patch has its shape, and where its edges say that it stands."""

from __future__ import annotations

import math
from typing import TypeAlias

from robot_agent.vision.blobs import Blob
from robot_agent.vision.camera_model import CameraModel

TOLERANCE = 0.05
"""Of a length in the image; chosen: a skirt is cut and fastened by hand."""
GROWN_PX = 0.7
"""How much higher than the skirt its patch is: the body and the shadow do not bound it as white wall does."""
TILT_RAD = 0.02
"""How far the robot may be tilted: it moves the whole image up or down."""
SHRUNK_PX = 1.1
"""How much narrower than the skirt its patch is: blur takes about half a pixel from each side."""
SMALLEST_PART = 1 / 3
"""Of the skirt's width: less of it than this says too little."""


def fits_skirt(
    blob: Blob, model: CameraModel, range_m: float, bearing_rad: float, tolerance_px: float
) -> bool:
    """Whether the patch's height is right for the range that its two sides gave."""
    depth_m = max(range_m - SKIRT_RADIUS_M, 0.01) * math.cos(bearing_rad)
    height_px = model.focal_px * (SKIRT_TOP_M - SKIRT_BOTTOM_M) / depth_m
    seen_px = blob.height - GROWN_PX
    return _close(seen_px, height_px, tolerance_px) and _fits_above(blob, model, depth_m, tolerance_px)


def fits_part_of_skirt(blob: Blob, model: CameraModel, tolerance_px: float) -> bool:
    """Whether a patch with one side out of sight can be a third or more of a skirt, by its height."""
    depth_m = depth_from_height_m(blob, model)
    full_px = 2 * model.focal_px * SKIRT_RADIUS_M / (depth_m + SKIRT_RADIUS_M)
    enough = SMALLEST_PART * full_px < blob.width < (1 + TOLERANCE) * full_px + tolerance_px
    return enough and _fits_above(blob, model, depth_m, tolerance_px)


def depth_from_height_m(blob: Blob, model: CameraModel) -> float:
    """How far away, along the camera's axis, a skirt of the patch's height is."""
    return model.focal_px * (SKIRT_TOP_M - SKIRT_BOTTOM_M) / (blob.height - GROWN_PX)


def _fits_above(blob: Blob, model: CameraModel, depth_m: float, tolerance_px: float) -> bool:
    above_px = model.focal_px * (SKIRT_TOP_M - model.height_m) / depth_m
    slack_px = model.focal_px * TILT_RAD
    return _close(model.horizon_row - (blob.top - 0.5), above_px, tolerance_px + slack_px)


def _close(seen_px: float, expected_px: float, tolerance_px: float) -> bool:
    return abs(seen_px - expected_px) <= tolerance_px + TOLERANCE * expected_px


def sides_by_size(blob: Blob) -> tuple[float, float]:
    """Columns of a skirt's two sides, from its proportions and the number of the patch's pixels."""
    middle_px = (blob.left + blob.right - 1) / 2
    width_by_height = 2 * SKIRT_RADIUS_M / (SKIRT_TOP_M - SKIRT_BOTTOM_M)
    half_px = (math.sqrt(width_by_height * blob.area) + SHRUNK_PX) / 2
    return middle_px - half_px, middle_px + half_px


def sides_of_box(blob: Blob) -> tuple[float, float]:
    """Columns of the two sides of a patch of which a part is out of sight: the size says nothing there."""
    return blob.left - 0.5 - SHRUNK_PX / 2, blob.right - 0.5 + SHRUNK_PX / 2


Covariance: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Of (range, bearing), in metres and radians."""

SKIRT_RADIUS_M = 0.0355
"""The e-puck's: its diameter is 71 mm."""
SKIRT_BOTTOM_M = 0.004
SKIRT_TOP_M = 0.042
"""Chosen, the paper gives neither: it clears the floor and leaves the top of the body, of 50 mm, free."""


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
