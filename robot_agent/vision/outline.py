"""A patch's height and middle line: from the mask of its pixels, or finer, from its light."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.blobs import Blob, median
from robot_agent.vision.pixels import Words
from robot_agent.vision.skirt_colour import SkirtColour

OUTLINE_ASIDE = 0.15
"""Of the width, at each side; chosen: there the rims are bent most, and the blur rounds the corners."""
LIT_ASIDE = 0.25
"""Of the width, at each side, for the light: no blur from the sides reaches the middle half."""
RIM_PX = 5
"""Above and below the patch; more than the blur, less than the gap to a reflection in the floor."""
PLATEAU_PART = 0.7
"""Of a patch's rows, ordered by light; chosen: blurred rims and openings are below, highlights above."""


@dataclass(frozen=True)
class Outline:
    """A patch's height, and the line along its middle: its row at the middle column, and its slope."""

    height_px: float
    middle_row: float
    slope: float


def outline(blob: Blob, mask: NDArray[np.uint8]) -> Outline:
    """Taken from the middle columns; holes (a highlight, an opening) do not matter."""
    aside = int(blob.width * OUTLINE_ASIDE)
    columns = mask[blob.top : blob.bottom, blob.left + aside : blob.right - aside] != 0
    firsts = columns.argmax(axis=0)
    lasts = blob.height - 1 - columns[::-1].argmax(axis=0)
    middles, places = (firsts + lasts) / 2, np.arange(columns.shape[1]) - (columns.shape[1] - 1) / 2
    slope = float(places @ middles / max(places @ places, 1.0))
    middle = median(middles - slope * places)
    return Outline(median(lasts - firsts) + 1, blob.top + middle, slope)


def lit_outline(
    blob: Blob, mask: NDArray[np.uint8], words: Words, white: NDArray[np.float64], colour: SkirtColour
) -> Outline:
    """The height is the light of the skirt's hue over that of a full row, so neither blur nor what is above
    or below the skirt changes it, unless that is of the same hue."""
    seen = outline(blob, mask)
    aside = int(blob.width * LIT_ASIDE)
    first, last = max(0, blob.top - RIM_PX), min(words.shape[0], blob.bottom + RIM_PX)
    share = colour.share(words[first:last, blob.left + aside : blob.right - aside], white)
    inside = np.sort(share[blob.top - first : blob.bottom - first])
    full = max(float(inside[int(PLATEAU_PART * inside.size)]), 1e-6)
    parts = np.minimum(share / full, 1.0)
    height = float(parts.sum())
    middle = float(np.arange(first, last) @ parts) / max(height, 1e-6)
    return replace(seen, height_px=height, middle_row=middle)
