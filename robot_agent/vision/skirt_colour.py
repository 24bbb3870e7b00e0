"""Which of all the colours that a sensor can send are the skirt's, in a given light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.pixels import Words

PART_OF_LIGHT = 0.38
"""Of the skirt's at calibration; chosen: an e-puck's green boards are a third as bright as a green skirt."""
LATTICE = 0.05
"""Of the log of the white: lights that differ less share a table, which takes longer to make than a frame."""
NEXT_HUE = 1.0
"""Chosen: light that is 45 degrees off the skirt's hue, as yellow is from red, counts as none of it."""
MOST_TABLES = 100
"""Chosen: 6 MB; a lamp that wanders wider makes its tables anew."""

TURNS = np.exp(2j * np.pi / 3 * np.arange(3))


def opponent(colours: NDArray[np.floating], white: NDArray[np.floating]) -> NDArray[np.complex128]:
    """Where colours (n, 3) lie around white: the modulus is the saturation (1 if pure), the angle the hue."""
    balanced = colours / white
    return np.asarray(balanced @ TURNS / np.maximum(balanced.sum(axis=1), 1e-9), dtype=np.complex128)


class SkirtColour:
    """Makes, and keeps, the table over all words (1: skirt) for each light."""

    def __init__(self, skirt: Skirt, light: NDArray[np.float32], saturated_part: float) -> None:
        """`light`: linear red, green and blue of each word, shape (65536, 3).

        `saturated_part`: the least saturation of a pixel of the skirt, in parts of the skirt's own.
        """
        self._skirt = skirt
        self._light = light
        self._saturated_part = saturated_part
        middle = complex(opponent(np.array([skirt.colour]), np.ones(3))[0])
        self._saturation = abs(middle)
        self._weights = TURNS * np.conj(middle) / self._saturation
        self._tables: dict[tuple[int, ...], NDArray[np.uint8]] = {}

    def table(self, white: NDArray[np.float64]) -> NDArray[np.uint8]:
        """1 for the words that are the skirt's where a white wall is `white`."""
        key = tuple(round(step) for step in (np.log(white) / LATTICE).tolist())
        if key not in self._tables:
            if len(self._tables) >= MOST_TABLES:
                self._tables.clear()
            self._tables[key] = self._made(np.exp(np.array(key) * LATTICE))
        return self._tables[key]

    def share(self, words: Words, white: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much light of the skirt's hue each row has, in any unit."""
        return self.share_of(self._light[words].mean(axis=1), white)

    def share_of(self, colours: NDArray[np.float32], white: NDArray[np.float64]) -> NDArray[np.float64]:
        """How much light of the skirt's hue is in colours (n, 3): grey light has none, however bright."""
        hue = (colours / white) @ self._weights
        return np.asarray(np.maximum(hue.real - NEXT_HUE * np.abs(hue.imag), 0.0))

    def _made(self, white: NDArray[np.float64]) -> NDArray[np.uint8]:
        """Turned so that the skirt's hue lies along the real axis."""
        skirt, weights = self._skirt, self._weights
        balanced = self._light / white.astype(np.float32)
        brightness = balanced.sum(axis=1)
        along = balanced @ weights.real.astype(np.float32)
        aside = np.abs(balanced @ weights.imag.astype(np.float32))
        is_skirt = (
            (aside < np.float32(np.tan(skirt.hue_tolerance_rad)) * along)
            & (along > np.float32(self._saturated_part * self._saturation) * brightness)
            & (balanced.max(axis=1) > PART_OF_LIGHT * max(skirt.colour))
        )
        return np.asarray(is_skirt, dtype=np.uint8)
