"""Connected patches of a skirt's colour."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

MIN_AREA_PART = 6e-4
"""Of the image; a skirt that is 1.7 m away fills twice this."""
MIN_FILL = 0.6


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


def blobs_at_horizon(mask: NDArray[np.uint8], horizon_row: float) -> list[Blob]:
    """The patches of non-zero pixels that are large and reach across the horizon, the largest first."""
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8, ltype=cv2.CV_16U)
    tops, heights, areas = (stats[1:, i] for i in (cv2.CC_STAT_TOP, cv2.CC_STAT_HEIGHT, cv2.CC_STAT_AREA))
    keep = (areas >= MIN_AREA_PART * mask.size) & (tops <= horizon_row) & (tops + heights > horizon_row)
    rows = stats[1:][keep].tolist()
    found = [Blob(left, top, left + wide, top + high, area) for left, top, wide, high, area in rows]
    return sorted(found, key=lambda blob: blob.area, reverse=True)
