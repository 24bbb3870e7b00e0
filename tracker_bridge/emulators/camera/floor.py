"""The floor below the emulated camera: plain, or with what tempts a detector of tags."""

from __future__ import annotations

import math

import cv2
import numpy as np
import numpy.typing as npt

from tracker_bridge.emulators.camera.optics import Optics

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

FLOOR_GREY, LINE_GREY = 150, 95
FINER = 8
"""Pixels a module before a print is laid: edges between modules stay sharp."""


def plain_floor(optics: Optics, rng: np.random.Generator) -> Grey:
    """Grey linoleum with a coarse grain and dark joints."""
    coarse = rng.normal(FLOOR_GREY, 12, (optics.height // 12 + 1, optics.width // 12 + 1)).astype(np.float32)
    size = (optics.width, optics.height)
    grain = np.asarray(cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC), dtype=np.float32)
    fine = grain + rng.normal(0, 4, grain.shape)
    picture = np.clip(fine, 0, 255).astype(np.uint8)
    for place in range(60, optics.width, 180):
        cv2.line(picture, (place, 0), (place + 9, optics.height), LINE_GREY, 2)
    for place in range(40, optics.height, 180):
        cv2.line(picture, (0, place), (optics.width, place - 6), LINE_GREY, 2)
    return picture


def littered_floor(optics: Optics, rng: np.random.Generator, objects: int = 60) -> Grey:
    """The same with printed squares of random modules: codes that belong to nobody."""
    picture = plain_floor(optics, rng)
    for _ in range(objects):
        modules = int(rng.integers(4, 9))
        code = np.pad(np.pad(rng.integers(0, 2, (modules, modules)), 1), 1, constant_values=1)
        place = rng.uniform(0, 1, 2) * (optics.width, optics.height)
        side_px, turn_rad = rng.uniform(18, 48), rng.uniform(0, 2 * math.pi)
        _lay(picture, (code * 200 + 25).astype(np.uint8), place, side_px, turn_rad)
    return picture


def _lay(picture: Grey, print_: Grey, place: Floats, side_px: float, turn_rad: float) -> None:
    """Put a square print into a picture, its upper left at a place."""
    fine = np.kron(print_, np.ones((FINER, FINER), dtype=np.uint8))
    scale = side_px / len(fine)
    cos, sin = scale * math.cos(turn_rad), scale * math.sin(turn_rad)
    turn = np.array([[cos, -sin, place[0]], [sin, cos, place[1]]])
    size = (picture.shape[1], picture.shape[0])
    cv2.warpAffine(fine, turn, size, picture, cv2.INTER_AREA, cv2.BORDER_TRANSPARENT)
