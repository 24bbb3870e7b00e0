"""The emulated camera's lens and place: which ray of the world a pixel sees."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

NEWTON_STEPS = 8
"""The residual of a lens with |k1| < 0.4 is then below 1e-9 at the corners of the picture."""


@dataclass(frozen=True)
class Optics:
    """A lens with radial and tangential distortion (Brown 1966), in pixels; (0, 0) is a pixel's middle.

    The defaults fit a 3 x 3 m arena into 1080 rows from 2.5 m above it, with the barrel distortion of
    a usual wide-angle lens.
    """

    width: int = 1920
    height: int = 1080
    focal_px: float = 910.0
    centre_u: float = 955.0
    centre_v: float = 543.0
    k1: float = -0.28
    k2: float = 0.08
    p1: float = 0.0006
    p2: float = -0.0004

    def distorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Pixels (u, v) of directions (x, y, 1)."""
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * self.k2)
        u = x * radial + 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x)
        v = y * radial + self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y
        return self.focal_px * u + self.centre_u, self.focal_px * v + self.centre_v

    def directions(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """(x, y) of the directions (x, y, 1) that pixels see: the inverse of `distorted`, by Newton's method.

        The Jacobian is taken as the radial factor alone; the steps converge all the same.
        """
        x = (u - self.centre_u) / self.focal_px
        y = (v - self.centre_v) / self.focal_px
        for _ in range(NEWTON_STEPS):
            r2 = x * x + y * y
            slope = 1 + r2 * (3 * self.k1 + 5 * r2 * self.k2)
            seen_u, seen_v = self.distorted(x, y)
            x = x + (u - seen_u) / (self.focal_px * slope)
            y = y + (v - seen_v) / (self.focal_px * slope)
        return x, y


@dataclass(frozen=True)
class Station:
    """Where the camera hangs and how it is turned, in the arena frame.

    Without turns it looks straight down with the picture's top to the north; pitch tips the view
    towards the north, roll towards the east, yaw turns the camera counter-clockwise seen from above.
    """

    x_m: float = 1.5
    y_m: float = 1.5
    height_m: float = 2.5
    pitch_rad: float = math.radians(1.5)
    roll_rad: float = math.radians(-1.0)
    yaw_rad: float = math.radians(2.0)

    @property
    def place(self) -> Floats:
        return np.array([self.x_m, self.y_m, self.height_m])

    @property
    def axes(self) -> Floats:
        """(3, 3): columns are the camera's right, down and forward in the arena frame."""
        down = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
        turned = _turn(2, self.yaw_rad) @ _turn(0, self.pitch_rad) @ _turn(1, -self.roll_rad) @ down
        return np.asarray(turned)


def _turn(axis: int, angle_rad: float) -> Floats:
    """(3, 3): a right-handed turn about x (0), y (1) or z (2)."""
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    turn: Floats = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle_rad)
    turn[j, i] = math.sin(angle_rad)
    turn[i, j] = -turn[j, i]
    return turn
