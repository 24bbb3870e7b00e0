"""A camera's lens: what turns its pixels into directions, and how it is found from pictures of a board."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from swarm.errors import UserError

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

FEWEST_PICTURES = 5
"""Fewer views do not separate focal length from distance."""
LARGEST_RESIDUAL_PX = 1.0
"""A board that bends or corners that were mistaken leave more than this."""
UNTIL_EXACT = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 1e-9)
"""OpenCV's usual 5 steps leave 0.3 mm at the corner of a 3 m arena under a wide lens."""
NO_DISTORTION = (0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Lens:
    """A pinhole with OpenCV's five coefficients of distortion (k1, k2, p1, p2, k3), for one picture size."""

    width: int
    height: int
    focal_u_px: float
    focal_v_px: float
    centre_u_px: float
    centre_v_px: float
    distortion: tuple[float, ...] = NO_DISTORTION
    residual_px: float = 0.0
    """Root mean square of the board's corners; 0 where the lens is given and not found."""

    @property
    def matrix(self) -> Floats:
        return np.array(
            [
                [self.focal_u_px, 0.0, self.centre_u_px],
                [0.0, self.focal_v_px, self.centre_v_px],
                [0.0, 0.0, 1.0],
            ]
        )

    @property
    def coefficients(self) -> Floats:
        return np.array(self.distortion)

    def directions(self, pixels: Floats) -> Floats:
        """(n, 2): x and y of the directions (x, y, 1) that (n, 2) pixels see."""
        flat = cv2.undistortPoints(
            pixels.reshape(-1, 1, 2), self.matrix, self.coefficients, criteria=UNTIL_EXACT
        )
        return np.asarray(flat, dtype=np.float64).reshape(-1, 2)


@dataclass(frozen=True)
class Board:
    """A chessboard, or a charuco board if it has markers; `columns` and `rows` count its squares."""

    columns: int
    rows: int
    square_m: float
    marker_m: float = 0.0
    family: int = cv2.aruco.DICT_4X4_50

    def corners(self, picture: Grey) -> tuple[Floats, Floats] | None:
        """Places on the board (n, 3) and in the picture (n, 2) of its inner corners; None if unseen."""
        return self._charuco_corners(picture) if self.marker_m else self._chessboard_corners(picture)

    def _chessboard_corners(self, picture: Grey) -> tuple[Floats, Floats] | None:
        inner = (self.columns - 1, self.rows - 1)
        found, pixels = cv2.findChessboardCornersSB(picture, inner, flags=cv2.CALIB_CB_ACCURACY)
        if not found:
            return None
        column, row = np.meshgrid(np.arange(inner[0]), np.arange(inner[1]))
        places = np.column_stack([column.ravel(), row.ravel(), np.zeros(column.size)]) * self.square_m
        return places.astype(np.float64), np.asarray(pixels, dtype=np.float64).reshape(-1, 2)

    def _charuco_corners(self, picture: Grey) -> tuple[Floats, Floats] | None:
        dictionary = cv2.aruco.getPredefinedDictionary(self.family)
        size = (self.columns, self.rows)
        board = cv2.aruco.CharucoBoard(size, self.square_m, self.marker_m, dictionary)
        pixels, numbers, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(picture)
        if numbers is None or len(numbers) < 6:  # a plane's pose takes four; two more show a mistake
            return None
        places = np.asarray(board.getChessboardCorners(), dtype=np.float64)[numbers.ravel()]
        return places, np.asarray(pixels, dtype=np.float64).reshape(-1, 2)


def find_lens(pictures: Iterable[Grey], board: Board) -> Lens:
    """The lens that explains pictures of a board held at different places and slants.

    Raises UserError if the board is seen in too few pictures or does not fit them.
    """
    views = [(picture.shape, board.corners(picture)) for picture in pictures]
    seen = [corners for _, corners in views if corners is not None]
    if len(seen) < FEWEST_PICTURES:
        raise UserError(
            f"the board was seen in {len(seen)} of {len(views)} pictures and {FEWEST_PICTURES} are needed; "
            "do its columns, rows and kind stand as it was printed?"
        )
    height, width = views[0][0]
    residual_px, matrix, distortion, _, _ = cv2.calibrateCamera(
        [places.astype(np.float32) for places, _ in seen],
        [pixels.astype(np.float32) for _, pixels in seen],
        (width, height),
        np.eye(3),
        np.zeros(5),
    )
    if residual_px > LARGEST_RESIDUAL_PX:
        raise UserError(
            f"the board's corners miss by {residual_px:.1f} px: is the board flat and are pictures sharp?"
        )
    return Lens(
        width,
        height,
        float(matrix[0, 0]),
        float(matrix[1, 1]),
        float(matrix[0, 2]),
        float(matrix[1, 2]),
        tuple(float(number) for number in np.ravel(distortion)[:5]),
        float(residual_px),
    )
