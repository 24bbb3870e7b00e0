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
        self._light = light
        self._calibrated = _hue(np.array([white]))[0]
        self._hue: NDArray[np.float64] | None = None
        above, below = model.height // 9, model.height // 7
        row = round(model.horizon_row)
        step = max(1, model.height // 48)
        self._rows = slice(max(0, row - above), row + below, step)
        self._columns = slice(None, None, step)

    def follow(self, words: Words) -> NDArray[np.float64]:
        """Linear red, green and blue of a white wall in this frame, in parts of full scale."""
        colours = self._light[words[self._rows, self._columns].ravel()]
        brightness = colours[:, 1]
        usable = colours[(colours.max(axis=1) < CLIPPED) & (colours.min(axis=1) > UNLIT)]
        if len(usable) > ENOUGH_PART * len(colours):
            found = _commonest(_hue(usable) - self._calibrated, usable[:, 1]) + self._calibrated
            self._hue = found if self._hue is None else self._hue + NEWEST_PART * (found - self._hue)
        hue = self._calibrated if self._hue is None else self._hue
        level = float(
            np.partition(brightness, int(WALL_PART * brightness.size))[int(WALL_PART * brightness.size)]
        )
        return max(level, 1e-3) * np.array([math.exp(hue[0]), 1.0, math.exp(hue[1])])


def _hue(colours: NDArray[np.floating]) -> NDArray[np.float64]:
    """Log of red and of blue over green."""
    logs = np.log(np.maximum(colours, 1e-4))
    return np.asarray(logs[:, ::2] - logs[:, 1:2], dtype=np.float64)


def _commonest(hues: NDArray[np.float64], weights: NDArray[np.float32]) -> NDArray[np.float64]:
    """The middle of the fullest place of a histogram; bright things, as walls are, weigh more."""
    cells = np.floor((hues + MOST_OFF) / BIN).astype(np.intp)
    inside = ((cells >= 0) & (cells < BINS)).all(axis=1)
    if not inside.any():
        return np.zeros(2)
    counts = np.bincount(cells[inside, 0] * BINS + cells[inside, 1], weights[inside], BINS * BINS)
    full = counts.reshape(BINS, BINS)
    wide = np.pad(full, 1)
    smooth = full + wide[:-2, 1:-1] + wide[2:, 1:-1] + wide[1:-1, :-2] + wide[1:-1, 2:]
    peak = np.array(np.unravel_index(int(smooth.argmax()), full.shape))
    middle = (peak + 0.5) * BIN - MOST_OFF
    near = np.abs(hues - middle).max(axis=1) < 2 * BIN
    return np.asarray(np.average(hues[near], axis=0, weights=weights[near]))
