"""Pictures to calibrate the emulated camera by: a chessboard held at many slants, and tags on the floor."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import numpy.typing as npt

from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.emulators.camera.scene import Swarm, TagPlate

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

BOARD_SQUARES, SQUARE_M = 10, 0.05
BOARD = 0
"""The board's number among the plates."""
BOARD_HEIGHTS_M = (0.3, 0.7, 1.1)
ROOM_M = 0.38
"""From the board's middle to a border of the view: half its diagonal."""
SLANTS_RAD = (math.radians(25), math.radians(40))
"""A board held level says little of the focal length: nearer and larger look alike."""


def board_pictures(camera: CameraRenderer, count: int, rng: np.random.Generator) -> Iterator[Grey]:
    """A chessboard of `BOARD_SQUARES` squares a side, held in all parts of the view in turn, and tilted."""
    code = np.indices((BOARD_SQUARES, BOARD_SQUARES)).sum(0) % 2
    for number in range(count):
        height_m = BOARD_HEIGHTS_M[number % len(BOARD_HEIGHTS_M)]
        plate = TagPlate(BOARD_SQUARES * SQUARE_M, SQUARE_M, height_m, body_radius_m=0.0)
        nearer = 1 - height_m / camera.station.height_m
        east, north = np.array(divmod(number % 9, 3)) - 1 + rng.uniform(-0.15, 0.15, 2)
        east_m, north_m = (part * (reach * nearer - ROOM_M) for part, reach in ((east, 2.3), (north, 1.45)))
        place = (camera.station.x_m + east_m, camera.station.y_m + north_m, rng.uniform(-math.pi, math.pi))
        slant_rad, towards_rad = rng.uniform(*SLANTS_RAD), rng.uniform(-math.pi, math.pi)
        tilt_rad = slant_rad * np.array([[math.cos(towards_rad), math.sin(towards_rad)]])
        held = Swarm((BOARD,), np.array([place]), np.zeros((1, 3)), tilt_rad)
        yield camera.with_plates(plate, {BOARD: code.astype(np.uint8)}).render(held)


def floor_picture(camera: CameraRenderer, codes: Mapping[int, Grey], poses: Floats, side_m: float) -> Grey:
    """Tags (in the order of `codes`) that lie on the floor at poses (n, 3)."""
    plate = TagPlate(side_m, side_m / 5, 0.0, body_radius_m=0.0)
    lying = Swarm(tuple(codes), poses, np.zeros_like(poses))
    return camera.with_plates(plate, dict(codes)).render(lying)
