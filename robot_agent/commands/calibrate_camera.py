"""`robot-agent calibrate camera`: field of view and distortion of a lens, from pictures of a chessboard."""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from swarm.errors import UserError
from swarm.runtime.process import OneLineParser

LEAST_PICTURES = 8
"""Fewer views do not tell the focal length from the distance (Zhang 2000 used five good ones)."""
LARGEST_ERROR_PX = 0.5
"""Corners of a sharp picture are found to a tenth of a pixel: more is a bent board, or two."""
PICTURES = (".png", ".jpg", ".jpeg")
FLAGS = cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3 | cv2.CALIB_FIX_ASPECT_RATIO
"""What `CameraModel` has: square pixels and two radial coefficients."""
REFINED = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 0.01)
"""When a corner's place is good enough: to a hundredth of a pixel."""


@dataclass(frozen=True)
class LensCalibration:
    """What the pictures say, for the [lens] table of a camera's file."""

    horizontal_field_of_view_deg: float
    radial: tuple[float, float]
    error_px: float
    """Root mean square distance of the corners from where this lens puts them."""
    pictures: int
    """Those in which the whole board was found."""


def calibrate_camera(arguments: argparse.Namespace) -> None:
    """Find the board in the pictures, and print the lens."""
    columns, rows = arguments.corners
    paths = sorted(path for path in arguments.frames.glob("*") if path.suffix.lower() in PICTURES)
    pictures = [
        picture for path in paths if (picture := cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)) is not None
    ]
    lens = lens_of([np.asarray(picture, dtype=np.uint8) for picture in pictures], columns, rows)
    print(json.dumps(vars(lens)) if arguments.json else _text(lens))


def lens_of(pictures: list[NDArray[np.uint8]], columns: int, rows: int) -> LensCalibration:
    """The lens behind grey pictures of a chessboard with so many inner corners.

    UserError if the board is in too few of them, or they do not agree.
    """
    if len({picture.shape for picture in pictures}) > 1:
        raise UserError("the pictures are not of one size: keep those of one camera")
    boards = [found for picture in pictures if (found := _corners(picture, columns, rows)) is not None]
    if len(boards) < LEAST_PICTURES:
        raise UserError(
            f"the board is whole in {len(boards)} of {len(pictures)} pictures: {LEAST_PICTURES} are needed, "
            "tilted each way, near the borders too; --corners counts inner corners"
        )
    height, width = pictures[0].shape
    board = np.zeros((rows * columns, 3), np.float32)
    board[:, :2] = np.mgrid[0:columns, 0:rows].T.reshape(-1, 2)
    start = np.array([[width, 0, (width - 1) / 2], [0, width, (height - 1) / 2], [0, 0, 1]], np.float64)
    error_px, matrix, bending, _, _ = cv2.calibrateCamera(
        [board] * len(boards),
        boards,
        (width, height),
        start,
        np.zeros(5),
        flags=FLAGS | cv2.CALIB_USE_INTRINSIC_GUESS,
    )
    if error_px > LARGEST_ERROR_PX:
        raise UserError(f"the pictures do not agree ({error_px:.2f} px): is the board flat, are they sharp?")
    k1, k2 = (float(value) for value in np.ravel(bending)[:2])
    angle_deg = _field_of_view_deg(width / 2 / float(matrix[0, 0]), k1, k2)
    return LensCalibration(angle_deg, (k1, k2), float(error_px), len(boards))


def _corners(picture: NDArray[np.uint8], columns: int, rows: int) -> NDArray[np.float32] | None:
    found, corners = cv2.findChessboardCorners(picture, (columns, rows))
    if not found:
        return None
    return np.asarray(cv2.cornerSubPix(picture, corners, (5, 5), (-1, -1), REFINED), dtype=np.float32)


def _field_of_view_deg(border: float, k1: float, k2: float) -> float:
    """The true angle between the borders, whose bent slope is `border`: bending undone by bisection."""
    low, high = 0.0, 2 * border
    for _ in range(50):
        slope = (low + high) / 2
        if slope * (1 + k1 * slope**2 + k2 * slope**4) < border:
            low = slope
        else:
            high = slope
    return 2 * math.degrees(math.atan(low))


def _text(lens: LensCalibration) -> str:
    """Lines for the camera's file."""
    k1, k2 = lens.radial
    return (
        f"horizontal_field_of_view_deg = {lens.horizontal_field_of_view_deg:.2f}\n"
        f"radial = [{k1:.4f}, {k2:.4f}]  # {lens.pictures} pictures, {lens.error_px:.2f} px"
    )


def _counts(text: str) -> tuple[int, int]:
    columns, _, rows = text.partition("x")
    return int(columns), int(rows)


def calibrate_camera_parser() -> OneLineParser:
    parser = OneLineParser(
        prog="robot-agent calibrate camera",
        description="Learns field of view and distortion of a camera from pictures of a flat chessboard, "
        "held at many angles and near each border. Prints the lines for the [lens] table of its file.",
    )
    parser.add_argument("--frames", type=Path, required=True, metavar="DIR", help="pictures: png or jpg")
    parser.add_argument(
        "--corners", type=_counts, default=(9, 6), metavar="9x6", help="inner corners of the board"
    )
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object")
    return parser
