"""The colour and strength of the light, from the white walls and the grey floor in each frame."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Colour
from robot_agent.vision.pixels import Words

MOST_OFF = 0.75
"""Of log (red / green) and of log (blue / green) from calibration; chosen: candles against daylight."""
BIN = 0.06
"""Of the same logarithms; chosen: a wall's noise fills two or three bins."""
BINS = round(2 * MOST_OFF / BIN)
CLIPPED = 0.93
"""Of full scale in linear light; brighter pixels may have lost what was above it."""
UNLIT = 0.01
"""Of full scale in linear light; darker pixels have no colour above the quantisation."""
ENOUGH_PART = 0.08
"""Of the sample; with fewer pixels left, the white of the frame before is kept."""
WALL_PART = 0.8
"""Chosen: the brightest fifth of what is white or grey is wall, not floor."""
NEWEST_PART = 0.4
"""Of the newest frame in the running mean: it averages noise, and follows a lamp in a second."""


class WhiteBalance:
    """Follows the white of the walls from frame to frame.

    The commonest hue near white is the wall's or the floor's: coloured things are smaller than either.
    """

    def __init__(self, model: CameraModel, light: NDArray[np.float32], white: Colour) -> None:
        """`light`: linear red, green and blue of each word, shape (65536, 3)."""
        self._calibrated = _hue(np.array([white]))[0]
        self._cells = _cells(_hue(light) - self._calibrated)
        self._cells[(light.max(axis=1) > CLIPPED) | (light.min(axis=1) < UNLIT)] = OUTSIDE
        self._brightness = np.ascontiguousarray(light[:, 1])
        self._hue: NDArray[np.float64] | None = None
        above, below = model.height // 9, model.height // 7
        row = round(model.horizon_row)
        step = max(1, model.height // 48)
        self._rows = slice(max(0, row - above), row + below, step)
        self._columns = slice(None, None, step)

    def follow(self, words: Words) -> NDArray[np.float64]:
        """Linear red, green and blue of a white wall in this frame, in parts of full scale."""
        sample = words[self._rows, self._columns].ravel()
        brightness, cells = self._brightness.take(sample), self._cells.take(sample)
        if np.count_nonzero(cells != OUTSIDE) > ENOUGH_PART * sample.size:
            found = _commonest(cells, brightness) + self._calibrated
            self._hue = found if self._hue is None else self._hue + NEWEST_PART * (found - self._hue)
        red, blue = self._calibrated if self._hue is None else self._hue
        brightness.sort()
        level = max(float(brightness[int(WALL_PART * brightness.size)]), 1e-3)
        return level * np.array([math.exp(red), 1.0, math.exp(blue)])


def _hue(colours: NDArray[np.floating]) -> NDArray[np.float64]:
    """Log of red and of blue over green."""
    logs = np.log(np.maximum(colours, 1e-4))
    return np.asarray(logs[:, ::2] - logs[:, 1:2], dtype=np.float64)


OUTSIDE = BINS * BINS
"""The cell of all colours that are too far from white, too dark or clipped."""


def _cells(hues: NDArray[np.float64]) -> NDArray[np.int64]:
    """The cell of the histogram of each hue."""
    places = np.floor((hues + MOST_OFF) / BIN).astype(np.int64)
    inside = ((places >= 1) & (places < BINS - 1)).all(axis=1)
    return np.where(inside, places[:, 0] * BINS + places[:, 1], OUTSIDE)


def _commonest(cells: NDArray[np.int64], weights: NDArray[np.float32]) -> NDArray[np.float64]:
    """The middle of the fullest place of the histogram; bright things, as walls are, weigh more."""
    full = np.bincount(cells, weights, OUTSIDE + 1)[:OUTSIDE].reshape(BINS, BINS)
    wide = full[1:-1, 1:-1] + full[:-2, 1:-1] + full[2:, 1:-1] + full[1:-1, :-2] + full[1:-1, 2:]
    row, column = divmod(int(wide.argmax()), BINS - 2)
    near = full[row : row + 3, column : column + 3]
    steps = np.arange(3)
    offset = np.array([steps @ near.sum(axis=1), steps @ near.sum(axis=0)]) / near.sum()
    return np.asarray((np.array([row, column]) + offset + 0.5) * BIN - MOST_OFF)
