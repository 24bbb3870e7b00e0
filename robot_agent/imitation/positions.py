"""Where the demonstrator was seen: positions with covariances, without those no robot could produce."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import Pose

OWN_HEADING_SD_RAD = math.radians(0.3)
"""Default error of the observer's heading from one frame to the next: tracker and odometry, fused."""

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


Floats = NDArray[np.float64]

FARTHEST_M = 100.0
"""No laboratory is larger: beyond it a coordinate is a fault."""
LEAST_SD_M = 1e-4
"""No camera is better: keeps every covariance invertible."""


@dataclass(frozen=True)
class Trajectory:
    """N positions in the order of time."""

    t_ns: NDArray[np.int64]  # [N]
    xy_m: Floats  # [N, 2]
    covariance_m2: Floats  # [N, 2, 2]

    @property
    def t_s(self) -> Floats:
        """Seconds since the first position."""
        return (self.t_ns - self.t_ns[:1]).astype(np.float64) * 1e-9

    def __len__(self) -> int:
        return len(self.t_ns)

    def where(self, chosen: NDArray[np.bool_]) -> Trajectory:
        return Trajectory(self.t_ns[chosen], self.xy_m[chosen], self.covariance_m2[chosen])

    def positions(self) -> tuple[ObservedPosition, ...]:
        rows = zip(self.t_ns.tolist(), self.xy_m.tolist(), self.covariance_m2.tolist(), strict=True)
        return tuple(
            ObservedPosition(t, x, y, ((xx, xy), (yx, yy))) for t, (x, y), ((xx, xy), (yx, yy)) in rows
        )


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


WINDOW = 5
CHI2_GATE = 25.0
ROBOT_SPEED_M_S = 0.13
"""What a robot can really have moved from the median's time; the e-puck's wheels allow no more."""


def inliers(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Which positions lie within the gate around the median of the five positions around them."""
    if len(trajectory) < 3:
        return np.ones(len(trajectory), dtype=np.bool_)
    medians_m, spans_s = _medians(trajectory)
    moved_m2 = (ROBOT_SPEED_M_S * spans_s) ** 2
    covariance_m2 = trajectory.covariance_m2 + moved_m2[:, None, None] * np.eye(2)
    distances = chi2(trajectory.xy_m - medians_m, covariance_m2)
    inside: NDArray[np.bool_] = distances <= CHI2_GATE
    return inside


def chi2(difference_m: Floats, covariance_m2: Floats) -> Floats:
    """Squared Mahalanobis lengths of differences [N, 2] under covariances [N, 2, 2]."""
    (xx, xy), (_, yy) = covariance_m2[:, 0].T, covariance_m2[:, 1].T
    x, y = difference_m.T
    result: Floats = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    return result


def _medians(trajectory: Trajectory) -> tuple[Floats, Floats]:
    """Of the window around each position: the median place and half the time it spans."""
    half = WINDOW // 2
    first = np.clip(np.arange(len(trajectory)) - half, 0, max(len(trajectory) - WINDOW, 0))
    window = np.minimum(first[:, None] + np.arange(WINDOW), len(trajectory) - 1)
    t_s = trajectory.t_s[window]
    return np.median(trajectory.xy_m[window], axis=1), (t_s[:, -1] - t_s[:, 0]) / 2
