"""A lens is found from pictures of a board that OpenCV drew through it."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from robot_agent.commands.calibrate_camera import lens_of
from robot_agent.vision.camera_model import CameraModel
from swarm.errors import UserError

COLUMNS, ROWS, SQUARE_PX = 9, 6, 20
MODEL = CameraModel(320, 240, math.radians(53.0), radial=(-0.08, 0.01))


def board() -> NDArray[np.uint8]:
    squares = np.indices((ROWS + 1, COLUMNS + 1)).sum(axis=0) % 2
    picture = np.kron(squares, np.ones((SQUARE_PX, SQUARE_PX))) * 215 + 20
    return np.pad(picture, SQUARE_PX, constant_values=235).astype(np.uint8)


def picture(tilt_rad: tuple[float, float], place: tuple[float, float, float]) -> NDArray[np.uint8]:
    """The board, one unit a square, at a place before the lens: each pixel's ray is cut with its plane."""
    column, row = np.meshgrid(np.arange(MODEL.width), np.arange(MODEL.height))
    right, up = MODEL.slopes(column, row)
    rotation, _ = cv2.Rodrigues(np.array([*tilt_rad, 0.05]))
    rays = np.stack([right, -up, np.ones_like(right)], axis=-1) @ rotation
    origin = -np.array(place) @ rotation
    depth = -origin[2] / rays[..., 2]
    x, y = (origin[axis] + depth * rays[..., axis] for axis in (0, 1))
    middle = np.array([(COLUMNS + 3) / 2, (ROWS + 3) / 2])
    maps = (
        ((x + middle[0]) * SQUARE_PX - 0.5).astype(np.float32),
        ((y + middle[1]) * SQUARE_PX - 0.5).astype(np.float32),
    )
    drawn = cv2.remap(board(), *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=128)
    return np.asarray(cv2.GaussianBlur(drawn, (3, 3), 0.6), dtype=np.uint8)


def pictures() -> list[NDArray[np.uint8]]:
    tilts = [(0.0, 0.0), (0.4, 0.0), (-0.4, 0.1), (0.0, 0.45), (0.1, -0.45), (0.3, 0.3), (-0.3, -0.3)]
    places = [(0.0, 0.0, 16.0), (1.5, 1.0, 17.0), (-1.5, -1.0, 17.0)]
    return [picture(tilt, place) for tilt in tilts for place in places]


def test_a_known_lens_is_found() -> None:
    lens = lens_of(pictures(), COLUMNS, ROWS)
    assert lens.horizontal_field_of_view_deg == pytest.approx(53.0, abs=0.5)
    assert lens.error_px < 0.2
    slope = math.tan(math.radians(20))
    bent = 1 + lens.radial[0] * slope**2 + lens.radial[1] * slope**4
    assert bent == pytest.approx(1 - 0.08 * slope**2 + 0.01 * slope**4, abs=0.005)


def test_too_few_boards_are_refused_with_the_cure() -> None:
    with pytest.raises(UserError, match="whole in 0 of 9 pictures: 8 are needed"):
        lens_of([np.full((240, 320), 128, np.uint8)] * 9, COLUMNS, ROWS)
