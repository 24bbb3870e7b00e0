"""What a simulated arena looks like: white walls with faint stains, a grey floor, a laboratory behind."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.drivers.camera_scene import COLOURS

WALL_HEIGHT_M = 0.12
WALL = np.array(COLOURS["white"])
FLOOR = np.array([0.42, 0.41, 0.39])
LAMP_THETA_RAD = 2.2
"""The side that the brighter light comes from, in the arena frame."""


class Surfaces:
    """Textures drawn once for each camera; `texture` scales their contrast."""

    def __init__(self, texture: float, rng: np.random.Generator) -> None:
        grain = _smooth(rng.standard_normal((256, 256)), 1.0)
        patches = _smooth(rng.standard_normal((256, 256)), 12.0)
        self.floor = np.maximum(1 + texture * (0.05 * grain + 0.04 * patches), 0.2).astype(np.float32)
        stains = _smooth(rng.standard_normal((4096, 1)), 6.0)[:, 0]
        self.stains = np.maximum(1 + texture * 0.012 * stains, 0.2)
        self.panorama = _panorama(rng)


def _smooth(noise: NDArray[np.float64], sd: float) -> NDArray[np.float64]:
    """Noise blurred over `sd` samples, with a standard deviation of one."""
    size = (0, 0) if min(noise.shape) > 1 else (1, 2 * int(3 * sd) + 1)
    blurred = np.asarray(cv2.GaussianBlur(noise, size, sigmaX=sd, sigmaY=sd), dtype=np.float64)
    return np.asarray((blurred - blurred.mean()) / blurred.std())


def _panorama(rng: np.random.Generator) -> NDArray[np.float32]:
    """Blurred furniture and windows, shape (3, 512 bearings, 64 elevations of 0.01 rad)."""
    grey = _smooth(rng.standard_normal((512, 64)), 7.0)
    tint = np.stack([_smooth(rng.standard_normal((512, 64)), 9.0) for _ in range(3)])
    light = 0.25 * np.exp(0.6 * grey) * np.exp(0.2 * tint)
    return np.clip(light, 0.02, 1.1).astype(np.float32)
