"""Where the demonstrator was seen at one frame: a position with its covariance."""

from __future__ import annotations

import math
from dataclasses import dataclass

from swarm.geometry import Pose

OWN_HEADING_SD_RAD = math.radians(0.3)
"""Default error of the observer's heading from one frame to the next: tracker and odometry, fused.
The most that copies bear: a tracker's own noise of 1 degree ruined them in a prototype."""

Covariance = tuple[tuple[float, float], tuple[float, float]]
"""Of (x, y), in square metres."""


@dataclass(frozen=True)
class ObservedPosition:
    """The demonstrator's place at one frame, in the arena frame."""

    t_ns: int
    x_m: float
    y_m: float
    covariance: Covariance


def position_from_detection(
    own_pose: Pose,
    camera_forward_m: float,
    range_m: float,
    bearing_rad: float,
    range_sd_m: float,
    bearing_sd_rad: float,
    t_ns: int,
    own_heading_sd_rad: float = OWN_HEADING_SD_RAD,
) -> ObservedPosition:
    """Compose the own pose, the camera's offset ahead of the turning axis, and range and bearing.

    The bearing is measured at the camera from the own heading, to the left. The covariance is polar
    (`range_sd_m` along the line of sight, the angles' errors across it), rotated to x and y; an error
    of the own heading also swings the camera, which the small offset makes negligible.
    """
    camera = own_pose.compose(Pose(camera_forward_m, 0.0, 0.0))
    angle_rad = camera.theta_rad + bearing_rad
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    across_sd_m = range_m * math.hypot(bearing_sd_rad, own_heading_sd_rad)
    return ObservedPosition(
        t_ns,
        camera.x_m + range_m * cos,
        camera.y_m + range_m * sin,
        _rotated(range_sd_m**2, across_sd_m**2, cos, sin),
    )


def _rotated(along_m2: float, across_m2: float, cos: float, sin: float) -> Covariance:
    """A diagonal covariance (along, across) turned by the angle of `cos` and `sin`."""
    xx = along_m2 * cos * cos + across_m2 * sin * sin
    yy = along_m2 * sin * sin + across_m2 * cos * cos
    xy = (along_m2 - across_m2) * cos * sin
    return ((xx, xy), (xy, yy))
