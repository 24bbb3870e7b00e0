"""Connected patches of a skirt's colour."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

MIN_AREA_PART = 6e-4
"""Of the image; a skirt that is 1.7 m away fills twice this."""
MIN_FILL = 0.6
"""Chosen: a disc fills 0.79 of its box and a skirt nearly all; two things that touch fill less."""
USUAL_PART = 0.2
"""Of the height; chosen: columns that differ more from the median column are no part of a skirt."""
NOISY_COLUMNS = np.ones((1, 5), np.uint8)
"""Up to four columns in a row that differ, with a skirt at either side, are noise in them."""
RAGGED_PX = 2
"""Blur and noise leave so many uneven columns at each side."""


@dataclass(frozen=True)
class Blob:
    """A patch's bounding box in pixels (right and bottom are the first ones outside) and its area."""

    left: int
    top: int
    right: int
    bottom: int
    area: int

    @property
    def width(self) -> int:
        return self.right - self.left

    @property
    def height(self) -> int:
        return self.bottom - self.top

    @property
    def is_filled(self) -> bool:
        """Whether the patch is about a box; a skirt is, two things that touch are not."""
        return self.area >= MIN_FILL * self.width * self.height


def trimmed(blob: Blob, mask: NDArray[np.uint8]) -> Blob:
    """The blob less what sticks out at its sides: columns that hold much more or less of it than most do,
    or that hold it higher or lower.

    A thing of the same colour that touches the skirt is lower or higher than the skirt, or joined to it by
    a few pixels. The two columns at a side that the blur makes ragged stay.
    """
    columns = mask[blob.top : blob.bottom, blob.left : blob.right]
    counts = columns.sum(axis=0, dtype=np.int32)
    middles = np.arange(blob.height) @ columns / np.maximum(counts, 1)
    usual = np.abs(counts - median(counts)) <= 1.5 + USUAL_PART * blob.height
    usual &= np.abs(middles - median(middles)) <= 1.0 + USUAL_PART / 2 * blob.height
    bridged = cv2.morphologyEx(usual.view(np.uint8)[np.newaxis], cv2.MORPH_CLOSE, NOISY_COLUMNS)[0] != 0
    first, last = _longest_run(bridged)
    first, last = first if first > RAGGED_PX else 0, last if blob.width - last > RAGGED_PX else blob.width
    if last - first in (blob.width, 0) or first > last:
        return blob
    rows = np.flatnonzero(columns[:, first:last].any(axis=1))
    top, bottom = blob.top + int(rows[0]), blob.top + int(rows[-1]) + 1
    return Blob(blob.left + first, top, blob.left + last, bottom, int(counts[first:last].sum()))


def median(values: NDArray[np.number[Any]]) -> float:
    """The upper one of the two middle values, if they are two; NumPy's own takes five times as long."""
    return float(np.sort(values)[values.size // 2])


def _longest_run(true: NDArray[np.bool_]) -> tuple[int, int]:
    """First and one past the last index of the longest run of True; (0, 0) if there is none."""
    steps = np.flatnonzero(np.diff(true, prepend=False, append=False))
    starts, ends = steps[::2], steps[1::2]
    if not starts.size:
        return 0, 0
    longest = int(np.argmax(ends - starts))
    return int(starts[longest]), int(ends[longest])


def blobs_at_horizon(
    mask: NDArray[np.uint8],
    horizon_row: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    slack_px: float,
) -> list[Blob]:
    """The patches of non-zero pixels that are large and reach across the horizon, the largest first.

    `horizon_row` tells the horizon's rows of columns; it may be `slack_px` higher or lower.
    """
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8, ltype=cv2.CV_16U)
    stats = stats[1:][stats[1:, cv2.CC_STAT_AREA] >= MIN_AREA_PART * mask.size]
    lefts, widths = stats[:, cv2.CC_STAT_LEFT], stats[:, cv2.CC_STAT_WIDTH]
    tops, heights = stats[:, cv2.CC_STAT_TOP], stats[:, cv2.CC_STAT_HEIGHT]
    horizon = horizon_row(lefts + (widths - 1) / 2)
    across = (tops <= horizon + slack_px) & (tops + heights > horizon - slack_px)
    rows = stats[across].tolist()
    found = [Blob(left, top, left + wide, top + high, area) for left, top, wide, high, area in rows]
    found = [trimmed(blob, mask) for blob in found]
    return sorted(found, key=lambda blob: blob.area, reverse=True)
