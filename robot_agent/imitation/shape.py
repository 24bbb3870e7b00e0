"""Whether a patch has a skirt's shape: how far the skirt's borders are from the horizon tells its depth.

The camera's height over the floor and the skirt's are known, so the width, the part above and the part
below the horizon must agree. A post of the same colour differs in one of them, but for a rare one.
"""

from __future__ import annotations

import math

from robot_agent.drivers.camera_model import CameraModel
from robot_agent.imitation.components import Blob
from robot_agent.imitation.cylinder import SKIRT_BOTTOM_M, SKIRT_RADIUS_M, SKIRT_TOP_M

TOLERANCE = 0.05
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
