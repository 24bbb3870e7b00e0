"""The geometry of a camera: lens and mounting, read from a calibration file.

Columns and rows are counted from the middle of the top-left pixel; bearings are counter-clockwise
from the camera's axis, so a thing to the left has a positive bearing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robot_agent.vision.demonstrator import Demonstrator, Hat, Skirt
from swarm.config.toml_files import ConfigFile
from swarm.errors import UserError
from swarm.geometry import Pose

NEWTON_STEPS = 8
"""More than enough: the error squares at every step, and no lens bends by more than `_bends_gently`."""

EXACT = 1e-12
"""Of a focal length; far below the rounding of pixels."""


@dataclass(frozen=True)
class CameraModel:
    """A level camera with a lens that bends radially: r_image = r (1 + k1 r^2 + k2 r^4).

    `horizontal_field_of_view_rad` is the true angle between the left and right border of the image,
    bending included. `horizon` is the height of the horizon in the image, as a part of the image's
    height from the top. `gamma` is the exponent of the sensor's tone curve: level = light^(1/gamma).
    """

    width: int
    height: int
    horizontal_field_of_view_rad: float
    radial: tuple[float, float] = (0.0, 0.0)
    horizon: float = 0.5
    gamma: float = 1.0
    forward_m: float = 0.03
    height_m: float = 0.028
    """Ahead of the turning axis and above the floor, as Webots' guide to the e-puck has them."""
    yaw_rad: float = 0.0

    def __post_init__(self) -> None:
        checks = {
            "width and height must be even, in 16..4096": _is_size(self.width) and _is_size(self.height),
            "the field of view must be in 10..150 degrees": 0.17 < self.horizontal_field_of_view_rad < 2.62,
            "the horizon must be in 0.1..0.9": 0.1 <= self.horizon <= 0.9,
            "gamma must be in 0.5..4": 0.5 <= self.gamma <= 4,
            "the camera must be 1..500 mm above the floor": 0.001 <= self.height_m <= 0.5,
            "the camera must be within 200 mm of the turning axis": abs(self.forward_m) <= 0.2,
            "the yaw must be within 90 degrees": abs(self.yaw_rad) <= math.pi / 2,
        }
        for wrong, holds in checks.items():
            if not holds:
                raise ValueError(wrong)
        if not self._bends_gently():
            raise ValueError(f"radial coefficients {self.radial} fold the image over")

    def _bends_gently(self) -> bool:
        k1, k2 = self.radial
        slant = math.tan(self.horizontal_field_of_view_rad / 2) * math.hypot(1, self.height / self.width)
        radii = np.linspace(0, 1.2 * slant, 50)
        return bool(np.all(1 + 3 * k1 * radii**2 + 5 * k2 * radii**4 > 0.1))

    @property
    def centre_column(self) -> float:
        return (self.width - 1) / 2

    @property
    def horizon_row(self) -> float:
        return self.horizon * self.height - 0.5

    @cached_property
    def focal_px(self) -> float:
        """Pixels per unit of slope at the middle of the image."""
        k1, k2 = self.radial
        slope = math.tan(self.horizontal_field_of_view_rad / 2)
        return self.width / 2 / (slope * (1 + k1 * slope**2 + k2 * slope**4))

    def slopes(self, column: ArrayLike, row: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The undistorted ray of a pixel, per unit of depth: (to the right, up)."""
        right = (np.asarray(column, dtype=np.float64) - self.centre_column) / self.focal_px
        up = (self.horizon_row - np.asarray(row, dtype=np.float64)) / self.focal_px
        bent = np.hypot(right, up)
        scale = self._straighten(bent)
        return right * scale, up * scale

    def _straighten(self, bent: NDArray[np.float64]) -> NDArray[np.float64]:
        """Undistorted over distorted radius, by Newton's method."""
        k1, k2 = self.radial
        radius = bent.copy()
        for _ in range(NEWTON_STEPS):
            error = radius * (1 + k1 * radius**2 + k2 * radius**4) - bent
            if float(np.max(np.abs(error), initial=0.0)) < EXACT:
                break
            radius -= error / (1 + 3 * k1 * radius**2 + 5 * k2 * radius**4)
        return np.divide(radius, bent, out=np.ones_like(bent), where=bent > 0)

    def bearing_rad(self, column: float) -> float:
        """The direction that a column (fractions allowed) looks at, on the horizon."""
        right, _ = self.slopes(column, self.horizon_row)
        return -math.atan(float(right))

    def level_bearings_rad(
        self, columns: ArrayLike, rows: ArrayLike, pitch_rad: float, roll_rad: float
    ) -> list[float]:
        """The directions that pixels look at, of a camera that is tilted (see `Tilt`)."""
        right, up = self.slopes(columns, rows)
        level_right = right * math.cos(roll_rad) - up * math.sin(roll_rad)
        level_up = right * math.sin(roll_rad) + up * math.cos(roll_rad)
        ahead = math.cos(pitch_rad) - level_up * math.sin(pitch_rad)
        return [float(bearing) for bearing in -np.arctan2(level_right, ahead)]

    def column(self, bearing_rad: float) -> float:
        """The column at which the horizon has this bearing: the inverse of `bearing_rad`."""
        k1, k2 = self.radial
        slope = -math.tan(bearing_rad)
        return self.centre_column + self.focal_px * slope * (1 + k1 * slope**2 + k2 * slope**4)

    def pose(self, robot: Pose) -> Pose:
        """Where the camera is, and where its axis points, on a robot that stands here."""
        return robot.compose(Pose(self.forward_m, 0.0, self.yaw_rad))

    def scaled(self, width: int, height: int) -> CameraModel:
        """The same camera read out at another resolution."""
        return replace(self, width=width, height=height)


def _is_size(pixels: int) -> bool:
    return 16 <= pixels <= 4096 and pixels % 2 == 0


@dataclass(frozen=True)
class ImageSettings:
    """[image]: the resolution."""

    width: int
    height: int


@dataclass(frozen=True)
class LensSettings:
    """[lens]: how directions become pixels and light becomes levels; see `CameraModel`."""

    horizontal_field_of_view_deg: float
    radial: tuple[float, float]
    horizon: float
    gamma: float


@dataclass(frozen=True)
class MountingSettings:
    """[mounting]: where the camera sits on the robot."""

    forward_m: float
    height_m: float
    yaw_deg: float


@dataclass(frozen=True)
class LightSettings:
    """[light]: a white wall's linear red, green and blue (parts of full scale) at calibration."""

    white: tuple[float, float, float]


@dataclass(frozen=True)
class CalibrationFile:
    """A calibration file (deploy/cameras/*.toml): a camera, and the demonstrator that it watches.

    The three tables of the camera must be there; `robot-agent calibrate` adds those of the demonstrator.
    """

    image: ImageSettings
    lens: LensSettings
    mounting: MountingSettings
    skirt: Skirt | None = None
    hat: Hat | None = None
    light: LightSettings | None = None

    def demonstrator(self) -> Demonstrator | None:
        """None if the file tells only of the camera, or of a skirt's size but not of its colour."""
        if self.skirt is None or self.light is None:
            return None
        return Demonstrator(self.skirt, self.hat, self.light.white)

    def model(self) -> CameraModel:
        """ValueError if no camera is like this."""
        image, lens, mounting = self.image, self.lens, self.mounting
        return CameraModel(
            image.width,
            image.height,
            math.radians(lens.horizontal_field_of_view_deg),
            lens.radial,
            lens.horizon,
            lens.gamma,
            mounting.forward_m,
            mounting.height_m,
            math.radians(mounting.yaw_deg),
        )


def load_calibration(path: Path | str) -> CalibrationFile:
    """Read a calibration file; UserError names the file and what is wrong with it."""
    try:
        calibration = ConfigFile(Path(path)).settings(CalibrationFile)
        calibration.model()
    except ValueError as error:
        raise UserError(f"camera calibration {path}: {error}") from error
    return calibration


def load_camera_model(path: Path | str) -> CameraModel:
    """The camera of a calibration file; UserError names the file and what is wrong with it."""
    return load_calibration(path).model()
