"""A single tag's pose in all six degrees of freedom, and whether it has a second solution.

Of a small tag, or one seen at less than 20 degrees from head-on, the perspective is too weak to say which way
it leans: two poses explain its corners almost equally well.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from tracker_bridge.overhead.lens import Lens

Floats = npt.NDArray[np.float64]

CORNER_ERROR_PX = 0.3
"""Of a corner, where a module has three pixels or more: deviation from the corners given for photographs."""
DOUBTFUL = 3.0
"""A second solution whose error is not so many times the first's, the corners' own added, may be true."""


@dataclass(frozen=True)
class TagPose:
    """Takes a tag's coordinates (x right, y up, z out of the print, from its middle) to the camera's."""

    rotation: Floats
    shift_m: Floats
    error_px: float
    """Root mean square of the corners."""


@dataclass(frozen=True)
class TagPoses:
    """The best pose and the second solution."""

    best: TagPose
    second: TagPose

    @property
    def ambiguity(self) -> float:
        """The best error over the second's, with the corners' own added: near 1, either may be true."""
        return (self.best.error_px + CORNER_ERROR_PX) / (self.second.error_px + CORNER_ERROR_PX)

    @property
    def is_ambiguous(self) -> bool:
        return self.ambiguity > 1 / DOUBTFUL


def tag_poses(corners: Floats, lens: Lens, side_m: float) -> TagPoses:
    """Both poses of a tag from its corners (4, 2), clockwise from the upper left (IPPE: Collins and Bartoli,
    Infinitesimal Plane-Based Pose Estimation, 2014)."""
    half = side_m / 2
    square = np.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])
    _, turns, shifts, errors = cv2.solvePnPGeneric(
        square, corners, lens.matrix, lens.coefficients, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    poses = [
        TagPose(
            np.asarray(cv2.Rodrigues(turn)[0], dtype=np.float64),
            np.asarray(shift, dtype=np.float64).ravel(),
            float(error),
        )
        for turn, shift, error in zip(turns, shifts, np.ravel(errors), strict=True)
    ]
    return TagPoses(poses[0], poses[-1])
