"""A camera's view of the arena: from corners of tags in its picture to poses in metres and radians."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from swarm.errors import UserError
from tracker_bridge.overhead.lens import Lens

Floats = npt.NDArray[np.float64]

LARGEST_RESIDUAL_PX = 3.0
"""Of known tags: a tag taped 1 cm from where it is said to be misses by about 4 px from 2.5 m."""
FEWEST_POINTS = 4
FOCAL_STEPS = 8
"""Each divides the error by ten or more for a camera that looks down at less than 30 degrees."""


@dataclass(frozen=True)
class PlanePose:
    """A level tag: its middle, the direction of its top edge, and how badly a square of its size fits."""

    x_m: float
    y_m: float
    theta_rad: float
    residual_m: float


@dataclass(frozen=True)
class ArenaView:
    """A lens and its place: `rotation` (3, 3) and `shift_m` (3,) take arena coordinates to the camera's."""

    lens: Lens
    rotation: Floats
    shift_m: Floats
    residual_px: float = 0.0

    @property
    def place_m(self) -> Floats:
        """(3,): where the camera hangs."""
        return np.asarray(-self.rotation.T @ self.shift_m)

    def pixels(self, places_m: Floats) -> Floats:
        """(n, 2): where (n, 3) places of the arena are seen."""
        turn = cv2.Rodrigues(self.rotation)[0]
        seen = cv2.projectPoints(places_m, turn, self.shift_m, self.lens.matrix, self.lens.coefficients)[0]
        return np.asarray(seen, dtype=np.float64).reshape(-1, 2)

    def at_height(self, pixels: Floats, height_m: float) -> Floats:
        """(n, 2): places at a height above the floor that (n, 2) pixels see.

        A tag on a robot stands nearer to the camera than the floor: taken for flat it would seem further out.
        """
        directions = self.lens.directions(pixels)
        rays = np.column_stack([directions, np.ones(len(directions))]) @ self.rotation
        place_m = self.place_m
        reach = (height_m - place_m[2]) / rays[:, 2]
        return np.asarray(place_m[:2] + reach[:, None] * rays[:, :2])

    def level_poses(self, quads: Floats, height_m: float, side_m: float) -> list[PlanePose]:
        """Poses of level tags from their corners in the picture (n, 4, 2)."""
        corners = self.at_height(quads.reshape(-1, 2), height_m).reshape(-1, 4, 2)
        return fitted_squares(corners, side_m)


def fitted_squares(corners_m: Floats, side_m: float) -> list[PlanePose]:
    """Squares of a given side, fitted to corners (n, 4, 2) by least squares (no scale).

    Points as complex numbers: the turn is the argument of the product with the square's own corners.
    """
    points = corners_m[..., 0] + 1j * corners_m[..., 1]
    middle = points.mean(1)
    # ahead is the real axis: upper left, upper right, lower right, lower left of the printed tag
    square = side_m / 2 * np.array([1 + 1j, 1 - 1j, -1 - 1j, -1 + 1j])
    turn = ((points - middle[:, None]) * square.conj()).sum(1)
    turn /= np.abs(turn) + 1e-12
    missed = np.abs(points - middle[:, None] - turn[:, None] * square)
    return [
        PlanePose(float(at.real), float(at.imag), float(np.angle(along)), float(np.sqrt((miss**2).mean())))
        for at, along, miss in zip(middle, turn, missed, strict=True)
    ]


def view_from_known_points(lens: Lens, places_m: Floats, pixels: Floats) -> ArenaView:
    """The view that shows known places (n, 3) at given pixels (n, 2).

    Raises UserError for too few points or points that do not fit.
    """
    if len(places_m) < FEWEST_POINTS:
        raise UserError(
            f"{len(places_m)} known points are seen and {FEWEST_POINTS} are needed (a tag gives 4)"
        )
    view = _placed(lens, places_m, pixels)
    missed_px = np.linalg.norm(view.pixels(places_m) - pixels, axis=1)
    if missed_px.max() > LARGEST_RESIDUAL_PX:
        worst = places_m[missed_px.argmax()]
        raise UserError(
            f"the known point at ({worst[0]:g}, {worst[1]:g}) m is seen {missed_px.max():.1f} px beside where"
            " the others put it: is its position, its heading or the lens wrong?"
        )
    return ArenaView(lens, view.rotation, view.shift_m, float(np.sqrt((missed_px**2).mean())))


def undistorted_lens(places_m: Floats, pixels: Floats, size: tuple[int, int], height_m: float) -> Lens:
    """A lens without distortion, its axis through the middle of a picture of a size (width, height), that
    puts the camera at a measured height over known places (n, 3).

    Of a camera that looks straight down nothing else tells the focal length: the height that is found grows
    in proportion to it.
    """
    width, height = size
    focal_px = float(width)
    for _ in range(FOCAL_STEPS):
        lens = Lens(width, height, focal_px, focal_px, (width - 1) / 2, (height - 1) / 2)
        focal_px *= height_m / float(_placed(lens, places_m, pixels).place_m[2])
    return lens


def _placed(lens: Lens, places_m: Floats, pixels: Floats) -> ArenaView:
    """The place of a camera from known points: in closed form, then by least squares."""
    is_plane = np.ptp(places_m[:, 2]) < 1e-9
    method = cv2.SOLVEPNP_IPPE if is_plane else cv2.SOLVEPNP_SQPNP
    found, turn, shift = cv2.solvePnP(places_m, pixels, lens.matrix, lens.coefficients, flags=method)
    if not found:
        raise UserError("no place of the camera explains the known tags: are their positions right?")
    turn, shift = cv2.solvePnPRefineLM(places_m, pixels, lens.matrix, lens.coefficients, turn, shift)
    return ArenaView(lens, np.asarray(cv2.Rodrigues(turn)[0]), np.asarray(shift, dtype=np.float64).ravel())


def corners_of_known_tags(
    poses: Mapping[int, tuple[float, float, float, float]], side_m: float
) -> dict[int, Floats]:
    """(4, 3) corners of tags that lie at known (x_m, y_m, height_m, theta_rad)."""
    half = side_m / 2
    ahead, left = np.array([half, half, -half, -half]), np.array([half, -half, -half, half])
    corners = {}
    for tag, (x_m, y_m, height_m, theta_rad) in poses.items():
        cos, sin = np.cos(theta_rad), np.sin(theta_rad)
        corners[tag] = np.column_stack(
            [x_m + cos * ahead - sin * left, y_m + sin * ahead + cos * left, np.full(4, height_m)]
        )
    return corners
