"""The lens of a simulated camera: which part of the undistorted view each pixel sees, and how sharply."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.camera_model import CameraModel

FINE_PER_PIXEL = 2
MARGIN_PX = 5
APERTURE_SD_PX = 0.25
"""What the width of a pixel adds to the blur across; sampling between rows adds as much downwards."""


class Lens:
    """The fine image (see camera_kernels) and the map from pixels into it."""

    def __init__(self, model: CameraModel, blur_rad: float) -> None:
        right, up = model.slopes(*np.meshgrid(np.arange(model.width), np.arange(model.height)))
        row_slope = 1 / model.focal_px
        column_slope = row_slope / FINE_PER_PIXEL
        left, top = right.min() - MARGIN_PX * row_slope, up.max() + MARGIN_PX * row_slope
        columns = math.ceil((right.max() - left) / column_slope) + MARGIN_PX * FINE_PER_PIXEL
        rows = math.ceil((top - up.min()) / row_slope) + MARGIN_PX
        self.raster = np.array([left, column_slope, top, row_slope])
        self.fine = np.zeros((3, columns, rows), dtype=np.float32)
        self.walls_m = np.zeros(columns)
        self.blurred = np.zeros_like(self.fine)
        self.map_x = ((right - left) / column_slope - 0.5).astype(np.float32)
        self.map_y = ((top - up) / row_slope - 0.5).astype(np.float32)
        blur_px = blur_rad * model.focal_px
        self._down = gaussian_taps(blur_px)
        self._across = gaussian_taps(math.hypot(blur_px, APERTURE_SD_PX) * FINE_PER_PIXEL)

    def blur(self, turned_slope: float) -> None:
        """Fill `blurred`: the view moves by `turned_slope` across while the shutter is open."""
        moved = turned_slope / self.raster[1]
        across = self._across if moved < 0.2 else np.convolve(self._across, box_taps(moved))
        for sharp, blurred in zip(self.fine, self.blurred, strict=True):
            cv2.sepFilter2D(sharp, cv2.CV_32F, kernelX=self._down, kernelY=across, dst=blurred)


def gaussian_taps(sd: float) -> NDArray[np.float32]:
    """Weights of a Gaussian of this standard deviation, of odd length, cut off at 3 standard deviations."""
    reach = max(1, math.ceil(3 * sd))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sd, 1e-3)) ** 2)
    return np.asarray(weights / weights.sum(), dtype=np.float32)


def box_taps(length: float) -> NDArray[np.float32]:
    """Weights of a running mean over a length (fractions allowed), of odd length."""
    reach = math.ceil(max(0.0, (length - 1) / 2))
    weights = np.clip((length + 1) / 2 - np.abs(np.arange(-reach, reach + 1)), 0, 1)
    return np.asarray(weights / weights.sum(), dtype=np.float32)
