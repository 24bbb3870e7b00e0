"""The observed positions as arrays, without those that no robot could have produced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.imitation.observation import ObservedPosition

Floats = NDArray[np.float64]

FARTHEST_M = 100.0
"""No laboratory is larger: beyond it a coordinate is a fault."""
LEAST_SD_M = 1e-4
"""No camera is better: keeps every covariance invertible."""


@dataclass(frozen=True)
class Sightings:
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

    def where(self, chosen: NDArray[np.bool_]) -> Sightings:
        return Sightings(self.t_ns[chosen], self.xy_m[chosen], self.covariance_m2[chosen])

    def positions(self) -> tuple[ObservedPosition, ...]:
        rows = zip(self.t_ns.tolist(), self.xy_m.tolist(), self.covariance_m2.tolist(), strict=True)
        return tuple(
            ObservedPosition(t, x, y, ((xx, xy), (yx, yy))) for t, (x, y), ((xx, xy), (yx, yy)) in rows
        )


def plausible_sightings(positions: Sequence[ObservedPosition]) -> Sightings:
    """Sort by time; drop NaN, far away places, bad covariances, and a second position at the same time."""
    every = Sightings(
        np.array([position.t_ns for position in positions], dtype=np.int64),
        np.array([(p.x_m, p.y_m) for p in positions], dtype=np.float64).reshape(-1, 2),
        np.array([p.covariance for p in positions], dtype=np.float64).reshape(-1, 2, 2),
    )
    sound = every.where(_sound_places(every.xy_m) & _sound_covariances(every.covariance_m2))
    _, first = np.unique(sound.t_ns, return_index=True)
    kept = Sightings(sound.t_ns[first], sound.xy_m[first], sound.covariance_m2[first])
    return Sightings(kept.t_ns, kept.xy_m, kept.covariance_m2 + LEAST_SD_M**2 * np.eye(2))


def _sound_places(xy_m: Floats) -> NDArray[np.bool_]:
    return np.asarray((np.abs(xy_m) <= FARTHEST_M).all(axis=1), dtype=np.bool_)


def _sound_covariances(covariance_m2: Floats) -> NDArray[np.bool_]:
    """Finite, symmetric and not negative; NaN compares false."""
    xx, xy, yx, yy = covariance_m2.reshape(-1, 4).T
    with np.errstate(invalid="ignore", over="ignore"):
        finite = (np.abs(covariance_m2) <= FARTHEST_M**2).all(axis=(1, 2))
        proper = (xx >= 0) & (yy >= 0) & (np.abs(xy - yx) <= 1e-9) & (xy * yx <= xx * yy * (1 + 1e-9))
    sound: NDArray[np.bool_] = finite & proper
    return sound
