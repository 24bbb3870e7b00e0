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

from robot_agent.vision.blobs import Blob, median
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.outline import Outline
from robot_agent.vision.pixels import Words
from robot_agent.vision.skirt_colour import SkirtColour, opponent

REACH_PX = 4
"""Half the window around an edge; more than a blur of two pixels, so that it holds nearly the whole step."""
PLATEAU_PX = 4
"""Chosen: enough pixels on either side of the step for their noise to average out."""
LARGE_WIDTH = 480
"""From this image width on, windows are twice as wide: a lens's blur is larger in pixels."""
WIDER_PX = 2
"""Chosen: of the window at either side of a blurred edge."""
BLURRED_PX = 1.3
"""Of the edge from the patch's border: a sharp image's patch is hardly smaller than the skirt."""
BLURRED_SD_PX = 0.15
"""Of a blurred edge, besides noise: what is behind the skirt is less even over so many pixels."""
UNEVEN_PART = 1.0
"""A plateau that is off by so much light moves the edge by half the window times that part of the step."""
HUE_OFF_PX = 1.6
"""Chosen: five standard deviations of an edge in hue, which a Bayer mosaic samples at few pixels."""
HUE_DEVIATIONS = 3.0
"""Chosen: of the edge's noise, beside that."""
MAX_SHIFT_PX = 6.0
"""Farther from the patch's border than blur and noise explain is the edge of another thing."""
LOOKS = 3
"""At an edge: the patch's border is inside a blurred edge, and the first look may hold but a part of it."""
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
"""A Bayer mosaic's interpolation makes neighbouring pixels' noise alike: so much more varies their mean."""
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

    def __init__(
        self, model: CameraModel, skirt: Skirt, light: NDArray[np.float32], colour: SkirtColour
    ) -> None:
        """`light`: linear red, green and blue of each word, shape (65536, 3)."""
        self._model = model
        self._channel = skirt.edge_channel
        self._light = light
        self._colour = colour
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
        profile = self._profile(words, start, rows, self._reach)
        for _ in range(LOOKS):
            if profile is None:
                return None
            column = profile.column(self._channel)
            if abs(column + 0.5 - profile.looked_at) <= 1:
                break
            blurred = abs(column + 0.5 - start) > BLURRED_PX
            reach = self._reach + (WIDER_PX if blurred else 0)
            profile = self._profile(words, round(column + 0.5), rows, reach)
        if profile is None:
            return None
        column = profile.column(self._channel)
        if not profile.is_of_skirt(self._channel, white):
            return None
        if abs(column + 0.5 - start) > MAX_SHIFT_PX * self._reach / REACH_PX:
            return None
        hue_px = profile.hue_column(self._colour, white) - column
        if abs(hue_px) > HUE_OFF_PX * self._reach / REACH_PX + HUE_DEVIATIONS * profile.noise_sd_px(
            self._channel
        ):
            return None
        blurred_sd_px = BLURRED_SD_PX if abs(column + 0.5 - start) > BLURRED_PX else 0.0
        noise_sd_px = math.hypot(profile.noise_sd_px(self._channel), blurred_sd_px)
        return Edge(column, (rows.start + rows.stop - 1) / 2, noise_sd_px)

    def _profile(self, words: Words, start: int, rows: slice, reach: int) -> Profile | None:
        """The light around `start`; None too close to the border."""
        first = max(0, start - reach - self._plateau)
        outer = start - reach - first
        if outer < 2:
            return None
        light = self._light[words[rows, first : start + reach + self._plateau]]
        return Profile(light, first, outer, 2 * reach)


class Profile:
    """Light (rows, columns, 3) across a left edge: `outer` columns beside it, then `window` around it."""

    def __init__(self, light: NDArray[np.float32], first: int, outer: int, window: int) -> None:
        self._light, self._first, self._outer, self._window = light, first, outer, window
        self._mean = light.mean(axis=0)
        self.looked_at = first + outer + window // 2

    def _plateaus(self, channel: int) -> tuple[float, float, int]:
        """(light outside, light inside, the window's last column)."""
        profile = self._mean[:, channel]
        last = min(self._outer + self._window, profile.size - 1)
        return float(profile[: self._outer].mean()), median(profile[last:]), last

    def column(self, channel: int) -> float:
        """Where the profile steps down."""
        high, low, last = self._plateaus(channel)
        lit = float(self._mean[self._outer : last, channel].sum()) - low * (last - self._outer)
        part = min(max(lit / max(high - low, 1e-6), 0.0), float(last - self._outer))
        return self._first - 0.5 + self._outer + part

    def hue_column(self, colour: SkirtColour, white: NDArray[np.float64]) -> float:
        """Where the skirt's hue begins: coarser than `column`, but nothing dark beside the skirt moves it."""
        share = colour.share_of(self._mean, white)
        last = min(self._outer + self._window, share.size - 1)
        part = float(share[:last].sum()) / max(median(share[last:]), 1e-6)
        return self._first - 0.5 + last - part

    def is_of_skirt(self, channel: int, white: NDArray[np.float64]) -> bool:
        """Whether it steps down from wall or floor, as at a skirt's side."""
        high, low, _ = self._plateaus(channel)
        return high - low > MIN_STEP * white[channel] and _is_pale(
            self._mean[: self._outer].mean(axis=0), white
        )

    def noise_sd_px(self, channel: int) -> float:
        """Of the column: from the pixels' noise, and from how uneven what is beside the edge is."""
        high, low, last = self._plateaus(channel)
        pixels, mean = self._light[:, : self._outer, channel], self._mean[: self._outer, channel]
        rows = pixels.shape[0]
        noise = float(((pixels - mean) ** 2).sum()) / max((rows - 1) * self._outer, 1)
        uneven = float(mean.var() + self._mean[last:, channel].var()) * (self._window / 2) ** 2
        variance = LIKE_NEIGHBOURS * noise / rows * self._window + UNEVEN_PART**2 * uneven
        return math.sqrt(variance) / max(high - low, 1e-6)


def _is_pale(colour: NDArray[np.float32], white: NDArray[np.float64]) -> bool:
    saturation = abs(complex(opponent(colour[np.newaxis], white)[0]))
    return saturation < PALE_SATURATION and float((colour / white).max()) > PALE_LIGHT
