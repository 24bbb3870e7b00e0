"""The camera's place on the robot, its lens, and where a point of the scene falls in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from swarm.geometry import Pose
from tests.support.judge.scene import Image

Points = NDArray[np.float64]

NEWTON_STEPS = 8  # a radial polynomial of a few percent is inverted to rounding error in five


@dataclass(frozen=True)
class Lens:
    """What glass does: blur (standard deviation in pixels), distortion, darker corners.

    `k1`, `k2` are Brown's radial coefficients: a ray at r = tan(angle) falls at r (1 + k1 r^2 + k2 r^4) focal
    lengths from the middle. `vignetting` is the light lost in the corners, as a fraction.
    """

    blur_px: float = 0.6
    k1: float = -0.06
    k2: float = 0.0
    vignetting: float = 0.25


@dataclass(frozen=True)
class Camera:
    """A camera on a robot: `forward_m` ahead of the wheel axle's middle, `height_m` above the floor.

    `pitch_rad` > 0 looks down, `roll_rad` > 0 leans to the right; both are right-handed turns about
    the robot's left and forward axes. The field of view is that of the lens without its distortion.
    """

    width: int
    height: int
    horizontal_fov_rad: float
    height_m: float
    forward_m: float
    pitch_rad: float = 0.0
    roll_rad: float = 0.0
    lens: Lens = Lens()

    @property
    def focal_px(self) -> float:
        return self.width / 2 / math.tan(self.horizontal_fov_rad / 2)

    def pose(self, observer: Pose) -> Pose:
        """Where the camera is when the robot that carries it stands at `observer`."""
        return observer.compose(Pose(self.forward_m, 0.0, 0.0))

    @cached_property
    def rays(self) -> Points:
        """Directions (height + 1, width + 1, 3) through the corners of the pixels: forward, left, up."""
        v, u = np.mgrid[0 : self.height + 1, 0 : self.width + 1].astype(np.float64)
        right, down = (u - self.width / 2) / self.focal_px, (v - self.height / 2) / self.focal_px
        stretch = self._undistortion(np.hypot(right, down))
        rays = np.stack([np.ones_like(u), -right * stretch, -down * stretch], axis=-1) @ self._rotation.T
        return np.ascontiguousarray(rays)

    def project(self, points: Points) -> Points:
        """Pixel coordinates (n, 2), x right and y down from the corner, of points (n, 3).

        Points are forward, left, up of the camera, in the robot's axes; NaN behind the camera.
        """
        forward, left, up = (points @ self._rotation).T
        forward = np.where(forward > 0, forward, np.nan)
        right, down = -left / forward, -up / forward
        square = right**2 + down**2
        stretch = self.focal_px * (1 + self.lens.k1 * square + self.lens.k2 * square**2)
        return np.stack([self.width / 2 + right * stretch, self.height / 2 + down * stretch], axis=-1)

    def expose(self, radiance: Image) -> Image:
        """The light on the sensor: blurred, darker towards the corners."""
        blur = self.lens.blur_px
        if blur > 0:
            blurred = cv2.GaussianBlur(radiance, (0, 0), blur, borderType=cv2.BORDER_REFLECT)
            radiance = np.asarray(blurred, np.float32)
        return radiance * self._transmission

    @cached_property
    def _transmission(self) -> Image:
        v, u = np.mgrid[0 : self.height, 0 : self.width]
        x, y = (2 * u + 1) / self.width - 1, (2 * v + 1) / self.height - 1
        fraction: Image = (1 - self.lens.vignetting * (x**2 + y**2) / 2).astype(np.float32)
        return fraction[..., None]

    @cached_property
    def _rotation(self) -> Points:
        """From the camera's axes to the robot's: roll about forward, then pitch about left."""
        cos, sin = math.cos(self.pitch_rad), math.sin(self.pitch_rad)
        pitch = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
        cos, sin = math.cos(self.roll_rad), math.sin(self.roll_rad)
        rotation: Points = pitch @ np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
        return rotation

    def _undistortion(self, distorted: Points) -> Points:
        """The undistorted radius over the distorted one, by Newton's method."""
        k1, k2 = self.lens.k1, self.lens.k2
        radius = distorted.copy()
        for _ in range(NEWTON_STEPS):
            square = radius**2
            error = radius * (1 + k1 * square + k2 * square**2) - distorted
            radius -= error / (1 + 3 * k1 * square + 5 * k2 * square**2)
        return np.divide(radius, distorted, out=np.ones_like(radius), where=distorted > 0)
