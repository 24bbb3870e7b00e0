"""The floor below the emulated camera: plain, or with what tempts a detector of tags."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from tracker_bridge.emulators.camera.optics import Optics

Grey = npt.NDArray[np.uint8]

FLOOR_GREY, LINE_GREY = 150, 95


def plain_floor(optics: Optics, rng: np.random.Generator) -> Grey:
    """Grey linoleum with a coarse grain and dark joints."""
    coarse = rng.normal(FLOOR_GREY, 12, (optics.height // 12 + 1, optics.width // 12 + 1)).astype(np.float32)
    grain = cv2.resize(coarse, (optics.width, optics.height), interpolation=cv2.INTER_CUBIC)
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
        side = modules + 4
        middle = (side - 1) / 2
        turn = cv2.getRotationMatrix2D(
            (middle, middle), float(rng.uniform(0, 360)), rng.uniform(18, 48) / side
        )
        turn[:, 2] += (rng.uniform(0, optics.width), rng.uniform(0, optics.height))
        large = cv2.resize(
            (code * 200 + 25).astype(np.uint8), None, fx=8, fy=8, interpolation=cv2.INTER_NEAREST
        )
        turn[:, :2] /= 8
        size = (optics.width, optics.height)
        cv2.warpAffine(large, turn, size, picture, cv2.INTER_AREA, cv2.BORDER_TRANSPARENT)
    return picture
