"""The way of a demonstrator: what flows through the imitation chain, from the frames to the moves."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.positions import ObservedPosition

Floats = NDArray[np.float64]

CHI2_GATE = 25.0
"""A position farther than this (five s.d. in one dimension) from where it must be is an outlier."""
REST_SPEED_M_S = 0.05
"""Slower is standing; chosen: half of the 0.10 m/s at which robots drive."""


@dataclass(frozen=True)
class Trajectory:
    """N positions in the order of time."""

    t_ns: NDArray[np.int64]  # [N]
    xy_m: Floats  # [N, 2]
    covariance_m2: Floats  # [N, 2, 2]

    @property
    def t_s(self) -> Floats:
        """Seconds since the first position."""
        return (self.t_ns - self.t_ns[:1]).astype(np.float64) * 1e-9

    def __len__(self) -> int:
        return len(self.t_ns)

    def where(self, chosen: NDArray[np.bool_]) -> Trajectory:
        """Only the chosen positions, as a plain trajectory."""
        return Trajectory(self.t_ns[chosen], self.xy_m[chosen], self.covariance_m2[chosen])

    def positions(self) -> tuple[ObservedPosition, ...]:
        rows = zip(self.t_ns.tolist(), self.xy_m.tolist(), self.covariance_m2.tolist(), strict=True)
        return tuple(
            ObservedPosition(t, x, y, ((xx, xy), (yx, yy))) for t, (x, y), ((xx, xy), (yx, yy)) in rows
        )


@dataclass(frozen=True)
class Stop:
    """The positions `first` to `last`, both of them seen while the demonstrator stood still."""

    first: int
    last: int


@dataclass(frozen=True)
class SmoothedTrajectory(Trajectory):
    """The smoother's estimates at the times at which positions were seen, and the stops found among them."""

    seen: Trajectory
    """What the estimates were made of."""
    velocity_m_s: Floats  # [N, 2]
    stops: tuple[Stop, ...] = ()
    """In the order of time."""

    @property
    def speed_m_s(self) -> Floats:
        return np.hypot(self.velocity_m_s[:, 0], self.velocity_m_s[:, 1])

    @property
    def stands(self) -> NDArray[np.bool_]:
        """Whether the demonstrator stood still, at each position."""
        return np.asarray(self.speed_m_s <= REST_SPEED_M_S)

    def duration_s(self, stop: Stop) -> float:
        return float(self.t_s[stop.last] - self.t_s[stop.first])

    def place_m(self, stop: Stop) -> Floats:
        """The mean of the positions at rest; a blip in between does not count."""
        within = slice(stop.first, stop.last + 1)
        mean: Floats = self.xy_m[within][self.stands[within]].mean(axis=0)
        return mean

    def with_stops(self, stops: tuple[Stop, ...]) -> SmoothedTrajectory:
        return replace(self, stops=stops)


def chi2(difference_m: Floats, covariance_m2: Floats) -> Floats:
    """Squared Mahalanobis lengths of differences [N, 2] under covariances [N, 2, 2]."""
    (xx, xy), (_, yy) = covariance_m2[:, 0].T, covariance_m2[:, 1].T
    x, y = difference_m.T
    result: Floats = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)
    return result
