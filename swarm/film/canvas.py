"""What a film's pictures are drawn with: smooth shapes by OpenCV, letters by Pillow, in one's own units."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TypeAlias

import cv2
import numpy as np
from matplotlib.font_manager import FontProperties, findfont
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Colour: TypeAlias = tuple[int, int, int]
"""Red, green, blue, 0 to 255."""
Point: TypeAlias = tuple[float, float]
"""Pixels from the left and from the top."""

FRACTION_BITS = 4
"""OpenCV takes sixteenths of a pixel: a robot that creeps does not jump."""
WHITE: Colour = (255, 255, 255)
INK: Colour = (28, 28, 28)
QUIET: Colour = (110, 110, 110)
RULE: Colour = (226, 226, 222)
BLUE: Colour = (0, 114, 178)
ORANGE: Colour = (213, 94, 0)
GREEN: Colour = (0, 158, 115)


@cache
def _font(size: int, bold: bool) -> ImageFont.FreeTypeFont:
    """Matplotlib brings one along, so that all machines make the same film."""
    return ImageFont.truetype(findfont(FontProperties(weight="bold" if bold else "normal")), size)


class Canvas:
    """One picture (rows, columns, red green blue)."""

    def __init__(self, width: int, height: int) -> None:
        self.pixels: NDArray[np.uint8] = np.full((height, width, 3), 255, dtype=np.uint8)

    def copy(self) -> Canvas:
        """Another one with the same on it."""
        height, width, _ = self.pixels.shape
        canvas = Canvas(width, height)
        canvas.pixels[:] = self.pixels
        return canvas

    def line(self, points: Sequence[Point], colour: Colour, width: int = 1) -> None:
        """Through all points, open."""
        if len(points) > 1:
            cv2.polylines(self.pixels, [_fixed(points)], False, colour, width, cv2.LINE_AA, FRACTION_BITS)

    def polygon(self, points: Sequence[Point], colour: Colour) -> None:
        """Filled."""
        cv2.fillPoly(self.pixels, [_fixed(points)], colour, cv2.LINE_AA, FRACTION_BITS)

    def disc(self, centre: Point, radius: float, colour: Colour) -> None:
        """Filled."""
        (x, y), scale = _fixed([centre])[0], 1 << FRACTION_BITS
        at = (int(x), int(y))
        cv2.circle(self.pixels, at, round(radius * scale), colour, -1, cv2.LINE_AA, FRACTION_BITS)

    def box(self, corner: Point, opposite: Point, colour: Colour, width: int = -1) -> None:
        """Filled if `width` is negative."""
        first, second = (tuple(map(round, point)) for point in (corner, opposite))
        cv2.rectangle(self.pixels, first, second, colour, width)

    def picture(self, pixels: NDArray[np.uint8], corner: tuple[int, int], size: tuple[int, int]) -> None:
        """Another picture, scaled to (width, height)."""
        (left, top), (width, height) = corner, size
        scaled = cv2.resize(pixels, size, interpolation=cv2.INTER_NEAREST)
        self.pixels[top : top + height, left : left + width] = scaled

    def text(
        self, words: str, corner: Point, colour: Colour = INK, size: int = 16, bold: bool = False
    ) -> None:
        """Its top left corner."""
        image = Image.fromarray(self.pixels)
        ImageDraw.Draw(image).text(corner, words, fill=colour, font=_font(size, bold))
        self.pixels = np.array(image)


def _fixed(points: Sequence[Point]) -> NDArray[np.int32]:
    """Pixels count from their middle."""
    return np.round((np.array(points) - 0.5) * (1 << FRACTION_BITS)).astype(np.int32)
