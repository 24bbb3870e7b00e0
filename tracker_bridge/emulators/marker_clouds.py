"""What a marker tracker sees of a swarm with hats: points without names, some missing, some too many."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class CloudFaults:
    """The defaults are a poor tracker: a good one has a tenth of the noise."""

    noise_m: float = 0.001
    """Standard deviation in x and in y."""
    dropout: float = 0.05
    """Part of the markers missing in a cloud, each by itself."""
    occlusions_per_hour: float = 30.0
    """Of each marker: something stands between it and the cameras."""
    occlusion_s: float = 0.3
    flashes: float = 5.0
    """Mean number of stray points of a single cloud, anywhere."""
    reflections: int = 3
    """Stray points that stay."""


class MarkerClouds:
    """Clouds of hats' pins (n, k), metres ahead (real) and to the left (imaginary) of each robot's axis."""

    def __init__(self, pins: Points, side_m: float, faults: CloudFaults, rng: np.random.Generator) -> None:
        self._pins, self._side_m, self._faults, self._rng = pins, side_m, faults, rng
        self._reflections = rng.uniform(0, side_m, (faults.reflections, 2)) @ np.array([1, 1j])
        self._hidden_s = np.zeros(pins.shape)

    def cloud(self, poses: Floats, step_s: float) -> Points:
        """The points of robots at poses (n, 3), in no order, `step_s` after the last cloud."""
        faults, rng = self._faults, self._rng
        middles, turns = poses[:, :2] @ np.array([1, 1j]), np.exp(1j * poses[:, 2])
        seen = self._seen(step_s)
        points = (middles[:, None] + turns[:, None] * self._pins)[seen]
        noise = rng.normal(0, faults.noise_m, (len(points) + len(self._reflections), 2)) @ np.array([1, 1j])
        flashes = rng.uniform(0, self._side_m, (rng.poisson(faults.flashes), 2)) @ np.array([1, 1j])
        return rng.permutation(np.concatenate([np.append(points, self._reflections) + noise, flashes]))

    def _seen(self, step_s: float) -> npt.NDArray[np.bool_]:
        rng, faults = self._rng, self._faults
        begins = rng.random(self._pins.shape) < faults.occlusions_per_hour * step_s / 3600.0
        self._hidden_s = np.where(begins, faults.occlusion_s, self._hidden_s - step_s)
        return np.asarray((self._hidden_s <= 0) & (rng.random(self._pins.shape) >= faults.dropout))
