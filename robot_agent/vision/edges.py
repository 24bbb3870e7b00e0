"""The side edges of a skirt to a fraction of a pixel, in light rather than in the sensor's levels.

Some rows of the skirt's upper half, where the white wall or the floor is behind it, are averaged into one
profile across the image. An edge is where a sharp step between the plateaus on its two sides would hold as
much light as the profile does: that place does not depend on how blurred the edge is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.blobs import Blob, Outline
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.pixels import Words
from robot_agent.vision.skirt_colour import opponent

REACH_PX = 4
"""Half the window around an edge; more than a blur of two pixels, so that it holds nearly the whole step."""
PLATEAU_PX = 4
"""Chosen: enough pixels on either side of the step for their noise to average out."""
LARGE_WIDTH = 480
"""From this image width on, windows are twice as wide: a lens's blur is larger in pixels."""
MAX_SHIFT_PX = 3.0
"""Farther from the patch's border than the blur explains is the edge of another thing."""
PALE_SATURATION = 0.16
"""Chosen: of the wall and floor beside an edge, which the light's estimate makes white or grey."""
PALE_LIGHT = 0.25
"""Of the wall's; chosen: a shaded floor is lighter, a dark thing is not."""
MIN_STEP = 0.08
"""Of the wall's light; chosen: a lower step is no edge of a skirt."""
BAND_ABOVE = 0.13
"""Of the skirt's height; the rows lie so far above its middle, where the camera looks level at the wall."""
BAND_HALF = 0.18
"""Of the skirt's height: half of the rows that are averaged."""
MOST_HALF_ROWS = 10
"""Chosen: more rows of a near skirt cost time and add no precision that the bearing could use."""
LIKE_NEIGHBOURS = 3.0
"""A Bayer mosaic's interpolation makes neighbouring pixels' noise alike: the variance of their mean grows by this."""
COVER_ROWS = 3
"""How far up to look for the boards or a hat: farther up, it may be what is above the wall."""
COVERED = 0.7
"""Of the wall's light, in the darkest channel; chosen: boards and hats are below it even if blurred."""

SHADED = 0.5
"""Of the wall's light; chosen: a wall in the shade is lighter; what is darker beside a skirt is no wall."""


@dataclass(frozen=True)
class Edge:
    """Where a side is (pixel middles are whole), and the standard deviation that noise gives the column."""

    column: float
    row: float
    noise_sd_px: float


class EdgeFinder:
    """Finds the sides of a skirt in frames of one camera."""

    def __init__(self, model: CameraModel, skirt: Skirt, light: NDArray[np.float32]) -> None:
        """`light`: linear red, green and blue of each word, shape (65536, 3)."""
        self._model = model
        self._channel = skirt.edge_channel
        self._light = light
        larger = 2 if model.width >= LARGE_WIDTH else 1
        self._reach, self._plateau = REACH_PX * larger, PLATEAU_PX * larger

    def is_covered(self, words: Words, blob: Blob, white: NDArray[np.float64]) -> bool:
        """Whether something other than wall is right above a patch, as boards or a hat are above a skirt."""
        aside = blob.width // 4
        strip = words[max(0, blob.top - COVER_ROWS) : blob.top, blob.left + aside : blob.right - aside]
        if not strip.size:
            return False
        rows = self._light[strip].mean(axis=1) / white
        return float(rows.min()) < COVERED * self._beside(words, blob, white)

    def _beside(self, words: Words, blob: Blob, white: NDArray[np.float64]) -> float:
        """How bright what is left and right of the skirt's top is, in parts of the light's estimate."""
        rows = slice(max(0, blob.top - COVER_ROWS), blob.top)
        gap = 2 * self._reach
        sides = (words[rows, max(0, blob.left - gap) : blob.left], words[rows, blob.right : blob.right + gap])
        lights = [float((self._light[side] / white).min(axis=2).mean()) for side in sides if side.size]
        return min(1.0, max(SHADED, *lights)) if lights else 1.0

    def find(
        self, words: Words, blob: Blob, seen: Outline, white: NDArray[np.float64]
    ) -> tuple[Edge | None, Edge | None]:
        """The left and right edge of a patch of skirt, None for a side that is not against wall or floor."""
        half = blob.width // 2
        left = self._edge(words[:, : blob.left + half + 1], blob.left, self._rows(seen, -half), white)
        mirrored = words[:, ::-1][:, : self._model.width - blob.right + half + 1]
        right = self._edge(mirrored, self._model.width - blob.right, self._rows(seen, half), white)
        if right is not None:
            right = Edge(self._model.width - 1 - right.column, right.row, right.noise_sd_px)
        return left, right

    def _rows(self, seen: Outline, across_px: float) -> slice:
        """Rows that surely show the skirt's side: an even number, to treat the Bayer rows alike."""
        middle = seen.middle_row + seen.slope * across_px - BAND_ABOVE * seen.height_px
        half = int(min(max(1, round(BAND_HALF * seen.height_px)), MOST_HALF_ROWS * self._model.height / 240))
        first = min(max(0, round(middle + 0.5) - half), self._model.height - 2 * half)
        return slice(first, first + 2 * half)

    def _edge(self, words: Words, start: int, rows: slice, white: NDArray[np.float64]) -> Edge | None:
        """The left edge near column `start` of an image that ends within the skirt."""
        edge = self._edge_at(words, start, rows, white)
        if edge is not None and abs(edge.column + 0.5 - start) > 1:
            edge = self._edge_at(words, round(edge.column + 0.5), rows, white)
        return edge if edge is not None and abs(edge.column + 0.5 - start) < MAX_SHIFT_PX else None

    def _edge_at(self, words: Words, start: int, rows: slice, white: NDArray[np.float64]) -> Edge | None:
        """The edge within the window around `start`."""
        first = max(0, start - self._reach - self._plateau)
        outer = start - self._reach - first
        if outer < 2:
            return None
        light = self._light[words[rows, first : start + self._reach + self._plateau]]
        if not _is_pale(light[:, max(0, outer - self._plateau) : outer].mean(axis=(0, 1)), white):
            return None
        lit = light[:, :, self._channel]
        step = _step(lit.mean(axis=0), outer, 2 * self._reach)
        if step[1] < MIN_STEP * white[self._channel]:
            return None
        rows_seen, pixels = lit.shape[0], lit[:, :outer]
        noise = float(((pixels - pixels.mean(axis=0)) ** 2).sum()) / max((rows_seen - 1) * outer, 1)
        noise_sd_px = math.sqrt(LIKE_NEIGHBOURS * noise / rows_seen * 2 * self._reach) / step[1]
        return Edge(first - 0.5 + step[0], (rows.start + rows.stop - 1) / 2, noise_sd_px)


def _is_pale(colour: NDArray[np.float32], white: NDArray[np.float64]) -> bool:
    saturation = abs(complex(opponent(colour[np.newaxis], white)[0]))
    return saturation < PALE_SATURATION and float((colour / white).max()) > PALE_LIGHT


def _step(profile: NDArray[np.float32], outer: int, window: int) -> tuple[float, float]:
    """(where the profile steps down after its `outer` samples, in samples; by how much)."""
    last = min(outer + window, profile.size - 1)
    high, low = float(profile[:outer].mean()), float(np.median(profile[last:]))
    height = max(high - low, 1e-9)
    return outer + (float(profile[outer:last].sum()) - low * (last - outer)) / height, high - low
