"""The sensor of a simulated camera: exposure, colour cast, noise, Bayer mosaic, tone curve, bytes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from robot_agent.drivers.sim.rendering.conditions import Conditions
from robot_agent.drivers.sim.rendering.lens import Lens
from robot_agent.drivers.sim.rendering.scene import WALL
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.frames import BYTES_PER_PIXEL

TONE_STEPS = 4096
NOISE_SAMPLES = 1 << 19
"""Each frame takes its noise from a random place of a store of this many: drawing it afresh costs as much as
all the optics."""
DRIFT_MEMORY = 0.95
"""Part of the exposure's drift that is left at the next frame."""


class Sensor:
    """Turns the light of the fine image into the bytes of a frame."""

    def __init__(self, model: CameraModel, conditions: Conditions, rng: np.random.Generator) -> None:
        self._conditions = conditions
        self._rng = rng
        exposure = math.exp(conditions.exposure_spread * rng.standard_normal())
        cast = np.exp(conditions.cast_spread * rng.standard_normal(3))
        self._gains = conditions.white_level / WALL[1] * exposure * cast / cast.mean() * conditions.cast
        self._drift = 0.0
        levels = np.linspace(0, 1, TONE_STEPS) ** (1 / model.gamma)
        self._tone = np.round(255 * levels).astype(np.uint8)
        self._horizon_row = model.horizon_row
        shape = (model.height, model.width)
        self._noise = rng.standard_normal(NOISE_SAMPLES + model.width * model.height, dtype=np.float32)
        self._raw = np.zeros((model.height + 2, model.width + 2), dtype=np.float32)
        self._pixels = np.zeros((*shape, 3), dtype=np.uint8)
        self._packed = np.zeros((*shape, BYTES_PER_PIXEL), dtype=np.uint8)

    def develop(self, kernels: Any, lens: Lens, skew: float, pixel_format: str) -> bytes:
        """The bytes of one frame; `skew` as in `camera_kernels.expose`."""
        settings = self._conditions
        self._drift = DRIFT_MEMORY * self._drift + settings.exposure_drift * self._rng.standard_normal()
        gains = (self._gains * math.exp(self._drift)).astype(np.float32)
        start = int(self._rng.integers(NOISE_SAMPLES))
        shot, read_squared = 1 / settings.full_well_electrons, settings.read_noise**2
        kernels.expose(
            lens.blurred,
            lens.map_x,
            lens.map_y,
            gains,
            skew,
            self._horizon_row,
            self._noise[start:],
            shot,
            read_squared,
            self._raw,
        )
        kernels.demosaic(self._raw, self._tone, self._pixels)
        pack = kernels.pack_rgb565 if pixel_format == "rgb565" else kernels.pack_yuyv
        pack(self._pixels, self._packed)
        return self._packed.tobytes()
