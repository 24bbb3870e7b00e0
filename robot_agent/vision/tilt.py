"""How far a camera is tilted against its calibration, learnt from the demonstrator it sees.

A skirt's width says how far away it is, and so the row at which a level camera would see its middle. Where it
is seen instead is the tilt's doing: a Kalman filter over the frames of a run tells pitch from roll.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.camera_model import CameraModel

TILT_SD_RAD = math.radians(1.8)
"""Chosen, before anything was seen: a camera that is 3 degrees wrong is within the gate."""
MOST_TILT_RAD = math.radians(4.0)
"""Chosen: a camera that is tilted more is to be mounted anew."""
GATE = 2.2
"""Standard deviations; with the first sight of a skirt, 4 degrees."""
ROW_SD_PX = 1.0
"""Chosen: what is above and below a skirt moves its borders by so much, at 320 pixels of width."""
SLOPE_SD_PX = 1.0
"""Of a column's middle row, in the slope of a skirt's middle line."""
DOUBT_RAD = math.radians(0.4)
"""Chosen, for a frame without an answer: a wrong tilt is given up in two seconds."""
MOVED_SD_RAD = math.radians(1.0)
"""Chosen: a robot that was carried stands on another part of the floor, and on its other wheel."""


class Tilt:
    """Rows by which the image is lower than a level camera's, as pitch_px + roll * (column - middle)."""

    def __init__(self, model: CameraModel) -> None:
        self._model = model
        self._scale = model.width / 320
        self._state = np.zeros(2)
        self._first = np.diag([(TILT_SD_RAD * model.focal_px) ** 2, TILT_SD_RAD**2])
        self._spread = self._first.copy()

    @property
    def pitch_rad(self) -> float:
        """Positive: the camera looks up."""
        return float(self._state[0]) / self._model.focal_px

    @property
    def roll_rad(self) -> float:
        """Positive: the right of the image is lower."""
        return float(self._state[1])

    @property
    def pitch_sd_rad(self) -> float:
        return math.sqrt(self._spread[0, 0]) / self._model.focal_px

    @property
    def roll_sd_rad(self) -> float:
        return math.sqrt(self._spread[1, 1])

    def row_offset_px(self, column: float) -> float:
        """How much lower than a level camera's the image is there."""
        return float(self._state[0] + self._state[1] * (column - self._model.centre_column))

    def horizon_rows(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """The rows of the horizon in these columns."""
        across = columns - self._model.centre_column
        return np.asarray(self._model.horizon_row + self._state[0] + self._state[1] * across)

    def slack_px(self, column: float) -> float:
        """How far from that a skirt may be seen."""
        across = np.array([1.0, column - self._model.centre_column])
        return GATE * math.sqrt(across @ self._spread @ across)

    def learn(self, column: float, offset_px: float, slope: float, width_px: float) -> None:
        """A skirt was seen there so much lower, and its middle line has this slope."""
        across = column - self._model.centre_column
        self._update(np.array([1.0, across]), offset_px, (ROW_SD_PX * self._scale) ** 2)
        slope_sd = SLOPE_SD_PX * self._scale * math.sqrt(12 / max(width_px, 4.0) ** 3)
        self._update(np.array([0.0, 1.0]), slope, slope_sd**2 + 0.02**2)
        limit = np.array([MOST_TILT_RAD * self._model.focal_px, MOST_TILT_RAD])
        self._state = np.clip(self._state, -limit, limit)

    def doubt(self) -> None:
        """A frame gave no answer: perhaps the tilt is why."""
        self._widen(DOUBT_RAD)

    def moved(self) -> None:
        """The robot was set down anew."""
        self._widen(MOVED_SD_RAD)

    def _widen(self, sd_rad: float) -> None:
        self._spread = self._spread + np.diag([(sd_rad * self._model.focal_px) ** 2, sd_rad**2])
        if np.any(np.diag(self._spread) > np.diag(self._first)):
            self._spread = self._first.copy()

    def _update(self, across: NDArray[np.float64], seen: float, variance: float) -> None:
        gain = self._spread @ across / (across @ self._spread @ across + variance)
        self._state = self._state + gain * (seen - across @ self._state)
        self._spread = self._spread - np.outer(gain, across @ self._spread)
