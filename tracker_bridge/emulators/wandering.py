"""A simulated swarm that wanders about the arena, for rehearsals."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

MAX_SPEED_M_S = 0.129
"""An e-puck's: 1000 steps/s of 0.1288 mm."""
WHEEL_BASE_M = 0.053
MEAN_STRETCH_S = 1.0
"""Robots draw new wheel speeds about so often."""


class WanderingSwarm:
    """Robots with two wheels that draw speeds at random and turn on the spot before walls and each other."""

    def __init__(self, robots: int, side_m: float, gap_m: float, rng: np.random.Generator) -> None:
        self._side_m, self._gap_m, self._rng = side_m, gap_m, rng
        self.poses = _spread(robots, side_m, gap_m, rng)
        self._wheels = np.zeros((robots, 2))
        self._draw(np.ones(robots, dtype=np.bool_))

    @property
    def velocities(self) -> Floats:
        """(n, 3): east, north (m/s) and counter-clockwise (rad/s)."""
        speed_m_s = self._wheels.mean(1)
        turn_rad_s = (self._wheels[:, 1] - self._wheels[:, 0]) / WHEEL_BASE_M
        theta_rad = self.poses[:, 2]
        return np.stack([speed_m_s * np.cos(theta_rad), speed_m_s * np.sin(theta_rad), turn_rad_s], 1)

    def step(self, step_s: float) -> None:
        """Let time pass."""
        self._draw(self._rng.random(len(self.poses)) < step_s / MEAN_STRETCH_S)
        ahead = self.poses + step_s * self.velocities
        stuck = self._too_near(ahead) & ~self._too_near(self.poses, -1e-3)
        ahead[stuck, :2] = self.poses[stuck, :2]
        self._wheels[stuck] = self._wheels[stuck].mean(1, keepdims=True) * [[-1.0, 1.0]]
        self.poses = ahead

    def _draw(self, which: npt.NDArray[np.bool_]) -> None:
        """New wheel speeds; every fifth robot rests."""
        drawn = self._rng.uniform(-0.4, 1.0, (len(which), 2)) * MAX_SPEED_M_S
        drawn[self._rng.random(len(which)) < 0.2] = 0.0
        self._wheels[which] = drawn[which]

    def _too_near(self, poses: Floats, slack_m: float = 0.0) -> npt.NDArray[np.bool_]:
        return _conflicts(poses[:, :2], self._side_m, self._gap_m + slack_m)


def _conflicts(places: Floats, side_m: float, gap_m: float) -> npt.NDArray[np.bool_]:
    between = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + np.eye(len(places)) * side_m
    at_wall = (places < gap_m / 2) | (places > side_m - gap_m / 2)
    return np.asarray(at_wall.any(1) | (between < gap_m).any(1))


def _spread(robots: int, side_m: float, gap_m: float, rng: np.random.Generator) -> Floats:
    places: list[Floats] = []
    while len(places) < robots:
        place = rng.uniform(gap_m, side_m - gap_m, 2)
        if all(math.dist(place, other) > 1.2 * gap_m for other in places):
            places.append(place)
    return np.column_stack([np.array(places), rng.uniform(-math.pi, math.pi, robots)])
