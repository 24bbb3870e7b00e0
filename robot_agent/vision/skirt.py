"""A skirt as a cylinder: whether a patch has its shape, and where its edges say that it stands."""

from __future__ import annotations

import math
from typing import TypeAlias

from robot_agent.vision.blobs import Blob
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import SKIRT_RADIUS_M, Skirt
from robot_agent.vision.outline import Outline

TOLERANCE = 0.05
"""Of a length in the image; chosen: a skirt is cut and fastened by hand."""
SHRUNK_PX = 1.1
"""How much narrower than the skirt its patch is: blur takes about half a pixel from each side."""
SMALLEST_PART = 1 / 3
"""Of the skirt's width: less of it than this says too little."""


class SkirtShape:
    """The silhouette of a skirt in the images of a camera that may be tilted.

    `tolerance_px` is how far a patch's upper and lower border may be from where a skirt's would be.
    """

    def __init__(self, skirt: Skirt, model: CameraModel, tolerance_px: float) -> None:
        self._skirt = skirt
        self._model = model
        self._tolerance_px = tolerance_px

    def fits(self, seen: Outline, depth_m: float, tilted_px: float, slack_px: float) -> bool:
        """Whether a patch has the height and the row of a skirt at a depth.

        The image is `tilted_px` lower there than a level camera's, give or take `slack_px`.
        """
        off_px = self.row_offset_px(seen, depth_m) - tilted_px
        high = _close(seen.height_px, self.height_px(depth_m), self._tolerance_px)
        return high and _close(off_px, 0.0, self._tolerance_px + slack_px)

    def fits_part(self, blob: Blob, depth_m: float) -> bool:
        """Whether a patch with one side out of sight can be a third or more of a skirt, by its width."""
        full_px = 2 * self._model.focal_px * self._skirt.radius_m / (depth_m + self._skirt.radius_m)
        return SMALLEST_PART * full_px < blob.width < (1 + TOLERANCE) * full_px + self._tolerance_px

    def height_px(self, depth_m: float) -> float:
        """The height of a skirt whose nearest point is at this depth."""
        return self._model.focal_px * self._skirt.height_m / depth_m

    def row_offset_px(self, seen: Outline, depth_m: float) -> float:
        """How much lower a patch's middle is than a level camera would see a skirt's at this depth."""
        middle_m = (self._skirt.top_m + self._skirt.bottom_m) / 2
        lower_m = self._model.height_m - middle_m
        return seen.middle_row - (self._model.horizon_row + self._model.focal_px * lower_m / depth_m)

    def depth_from_height_m(self, seen: Outline) -> float:
        """How far away, along the camera's axis, the nearest point of a skirt of the patch's height is."""
        return self._model.focal_px * self._skirt.height_m / max(seen.height_px, 1.0)

    def depth_m(self, range_m: float, bearing_rad: float) -> float:
        """How far away, along the camera's axis, the nearest point of a skirt at a range and bearing is."""
        return max(range_m - self._skirt.radius_m, 0.01) * math.cos(bearing_rad)

    def sides_by_size(self, blob: Blob) -> tuple[float, float]:
        """Columns of a skirt's two sides, from its proportions and the number of the patch's pixels."""
        middle_px = (blob.left + blob.right - 1) / 2
        width_by_height = 2 * self._skirt.radius_m / self._skirt.height_m
        half_px = (math.sqrt(width_by_height * blob.area) + SHRUNK_PX) / 2
        return middle_px - half_px, middle_px + half_px


def sides_of_box(blob: Blob) -> tuple[float, float]:
    """Columns of the two sides of a patch of which a part is out of sight: the size says nothing there."""
    return blob.left - 0.5 - SHRUNK_PX / 2, blob.right - 0.5 + SHRUNK_PX / 2


def _close(seen_px: float, expected_px: float, tolerance_px: float) -> bool:
    return abs(seen_px - expected_px) <= tolerance_px + TOLERANCE * expected_px


Covariance: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Of (range, bearing), in metres and radians."""


def range_and_bearing(
    left_rad: float, right_rad: float, radius_m: float = SKIRT_RADIUS_M
) -> tuple[float, float]:
    """(range to the cylinder's axis in metres, bearing of the axis) from the bearings of its two edges."""
    half_rad = (left_rad - right_rad) / 2
    return radius_m / math.sin(half_rad), (left_rad + right_rad) / 2


def half_angle_rad(range_m: float, radius_m: float = SKIRT_RADIUS_M) -> float:
    """Half the angle that the cylinder fills at a range, seen from the camera."""
    return math.asin(min(1.0, radius_m / range_m))


def covariance(
    range_m: float, edge_sd_rad: float, mounting_sd_rad: float, radius_m: float = SKIRT_RADIUS_M
) -> Covariance:
    """Of (range, bearing) when both edges are seen, each with its own independent error.

    From d = R / sin(half): the range's standard deviation is d^2 `edge_sd_rad` / (R sqrt 2).
    `mounting_sd_rad` is what the camera's place on the robot adds to the bearing.
    """
    range_sd_m = edge_sd_rad / math.sqrt(2) * range_m**2 / radius_m
    return (range_sd_m**2, 0.0), (0.0, edge_sd_rad**2 / 2 + mounting_sd_rad**2)


def covariance_of_one_edge(
    range_m: float,
    range_sd_m: float,
    edge_sd_rad: float,
    mounting_sd_rad: float,
    side: int,
    radius_m: float = SKIRT_RADIUS_M,
) -> Covariance:
    """Of (range, bearing) when one edge (`side` 1: left, -1: right) is seen and the height gives the range.

    The bearing is the edge's less `side` times asin(R / d): a robot thought too far is also thought too
    close to that edge.
    """
    swing = side * radius_m / range_m**2
    bearing_variance = edge_sd_rad**2 + (swing * range_sd_m) ** 2 + mounting_sd_rad**2
    shared = swing * range_sd_m**2
    return (range_sd_m**2, shared), (shared, bearing_variance)
