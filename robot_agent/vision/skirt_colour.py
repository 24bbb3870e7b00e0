"""Which of all the colours that a sensor can send are the skirt's, in a given light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.demonstrator import Skirt

PART_OF_SATURATION = 0.45
"""Of the skirt's: lower than this, pixels of the wall beside it would count, unevenly, as skirt."""
PART_OF_LIGHT = 0.38
"""Of the skirt's at calibration; chosen: an e-puck's green boards are a third as bright as a green skirt."""
LATTICE = 0.05
"""Of the log of the white: lights that differ less share a table, which takes longer to make than a frame."""
MOST_TABLES = 100
"""Chosen: 6 MB; a lamp that wanders wider makes its tables anew."""

TURNS = np.exp(2j * np.pi / 3 * np.arange(3))


def opponent(colours: NDArray[np.floating], white: NDArray[np.floating]) -> NDArray[np.complex128]:
    """Where colours (n, 3) lie around white: the modulus is the saturation (1 if pure), the angle the hue."""
    balanced = colours / white
    return np.asarray(balanced @ TURNS / np.maximum(balanced.sum(axis=1), 1e-9), dtype=np.complex128)


class SkirtColour:
    """Makes, and keeps, the table over all words (1: skirt) for each light."""

    def __init__(self, skirt: Skirt, light: NDArray[np.float32]) -> None:
        """`light`: linear red, green and blue of each word, shape (65536, 3)."""
        self._skirt = skirt
        self._light = light
        self._tables: dict[tuple[int, ...], NDArray[np.uint8]] = {}

    def table(self, white: NDArray[np.float64]) -> NDArray[np.uint8]:
        """1 for the words that are the skirt's where a white wall is `white`."""
        key = tuple(round(step) for step in (np.log(white) / LATTICE).tolist())
        if key not in self._tables:
            if len(self._tables) >= MOST_TABLES:
                self._tables.clear()
            self._tables[key] = self._made(np.exp(np.array(key) * LATTICE))
        return self._tables[key]

    def _made(self, white: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Turned so that the skirt's hue lies along the real axis."""
        skirt = self._skirt
        middle = complex(opponent(np.array([skirt.colour]), np.ones(3))[0])
        weights = TURNS * np.conj(middle) / abs(middle)
        balanced = self._light / white.astype(np.float32)
        brightness = balanced.sum(axis=1)
        along = balanced @ weights.real.astype(np.float32)
        aside = np.abs(balanced @ weights.imag.astype(np.float32))
        is_skirt = (
            (aside < np.float32(np.tan(skirt.hue_tolerance_rad)) * along)
            & (along > np.float32(PART_OF_SATURATION * abs(middle)) * brightness)
            & (balanced.max(axis=1) > PART_OF_LIGHT * max(skirt.colour))
        )
        return np.asarray(is_skirt, dtype=np.uint8)
