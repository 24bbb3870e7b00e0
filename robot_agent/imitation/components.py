"""Connected patches of a skirt's colour, and whether one has the shape of a skirt."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.drivers.camera_model import CameraModel
from robot_agent.imitation.cylinder import SKIRT_BOTTOM_M, SKIRT_RADIUS_M, SKIRT_TOP_M, range_and_bearing

MIN_AREA_PART = 1.5e-4
MIN_FILL = 0.6
SHAPE_TOLERANCE = 0.22
SHAPE_TOLERANCE_PX = 1.8


@dataclass(frozen=True)
class Blob:
    """A patch's bounding box in pixels (right and bottom are the first ones outside) and its area."""

    left: int
    top: int
    right: int
    bottom: int
    area: int

    @property
    def width(self) -> int:
        return self.right - self.left

    @property
    def height(self) -> int:
        return self.bottom - self.top


def blobs_at_horizon(mask: NDArray[np.uint8], model: CameraModel) -> list[Blob]:
    """The patches of non-zero pixels that are large enough and reach across the horizon, the largest first."""
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8, ltype=cv2.CV_16U)
    tops, heights, areas = (stats[1:, i] for i in (cv2.CC_STAT_TOP, cv2.CC_STAT_HEIGHT, cv2.CC_STAT_AREA))
    horizon = model.horizon_row
    keep = (areas >= MIN_AREA_PART * mask.size) & (tops <= horizon) & (tops + heights > horizon)
    rows = stats[1:][keep].tolist()
    found = [Blob(left, top, left + wide, top + high, area) for left, top, wide, high, area in rows]
    return sorted(found, key=lambda blob: blob.area, reverse=True)


def looks_like_skirt(blob: Blob, model: CameraModel) -> bool:
    """Whether a patch that is wholly in view is a filled box of a skirt's proportions at a skirt's height.

    The camera's height over the floor is known, so the patch's width says where its upper and lower
    border must be.
    """
    if blob.area < MIN_FILL * blob.width * blob.height:
        return False
    left_rad, right_rad = model.bearing_rad(blob.left - 0.5), model.bearing_rad(blob.right - 0.5)
    range_m, bearing_rad = range_and_bearing(left_rad, right_rad)
    depth_m = max(range_m - SKIRT_RADIUS_M, 0.01) * math.cos(bearing_rad)
    above_px, below_px = borders_px(depth_m, model)
    return _close(model.horizon_row - (blob.top - 0.5), above_px) and _close(
        blob.bottom - 0.5 - model.horizon_row, below_px
    )


def borders_px(depth_m: float, model: CameraModel) -> tuple[float, float]:
    """How far the skirt's upper border is above the horizon, and the lower one below, at a depth."""
    return (
        model.focal_px * (SKIRT_TOP_M - model.height_m) / depth_m,
        model.focal_px * (model.height_m - SKIRT_BOTTOM_M) / depth_m,
    )


def _close(seen_px: float, expected_px: float) -> bool:
    return abs(seen_px - expected_px) <= SHAPE_TOLERANCE_PX + SHAPE_TOLERANCE * expected_px


def looks_like_skirt_cut_off(blob: Blob, model: CameraModel) -> bool:
    """Whether a patch that reaches the image's side border has a skirt's height above and below the horizon,
    and shows at least a third of its width."""
    if blob.area < MIN_FILL * blob.width * blob.height:
        return False
    depth_m = model.focal_px * (SKIRT_TOP_M - SKIRT_BOTTOM_M) / blob.height
    above_px, _ = borders_px(depth_m, model)
    full_width_px = 2 * model.focal_px * SKIRT_RADIUS_M / (depth_m + SKIRT_RADIUS_M)
    enough = full_width_px / 3 < blob.width < (1 + SHAPE_TOLERANCE) * full_width_px + SHAPE_TOLERANCE_PX
    return enough and _close(model.horizon_row - (blob.top - 0.5), above_px)
