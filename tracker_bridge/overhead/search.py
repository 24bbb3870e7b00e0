"""Where in a picture tags can be: printed modules rise and fall within a few pixels, floors do not."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

CELL_PX = 16
"""Side of a cell of the map of contrast: less than a tag, so that one or more cells lie within it."""
SMOOTHING_PX = 1.0
"""Noise of one pixel is a tenth after it; modules of 2.5 px stay."""
BUSY = 2.5
"""Contrast of a cell with print, of the picture's median. On rendered frames with up to 12 levels of noise,
1.4 px of defocus or a tenth of the light, 3.2 lost tags and 2.5 none."""
GAIN, LEAST_BUSY = 4, 3.0
"""Contrast is counted in quarters of a grey value; a noiseless floor has a median near 0."""


@dataclass(frozen=True)
class Window:
    """A part of a picture, in pixels."""

    left: int
    top: int
    right: int
    bottom: int

    @classmethod
    def around(cls, points: Floats, margin_px: float, picture: Grey) -> Window:
        """The smallest window with (n, 2) points and a margin, as far as the picture goes."""
        height, width = picture.shape
        (left, top), (right, bottom) = points.min(0) - margin_px, points.max(0) + margin_px
        return cls(
            int(np.clip(left, 0, width - 1)),
            int(np.clip(top, 0, height - 1)),
            int(np.clip(right + 1, 1, width)),
            int(np.clip(bottom + 1, 1, height)),
        )

    def lowered(self, rows: int) -> Window:
        """The window of the whole picture that is this one of a strip which begins so many rows down."""
        return Window(self.left, self.top + rows, self.right, self.bottom + rows)


def busy_windows(picture: Grey) -> list[Window]:
    """Windows that hold everything with the contrast of print, each with a margin of a cell or more."""
    height, width = picture.shape
    columns, rows = max(1, width // CELL_PX), max(1, height // CELL_PX)
    smooth = cv2.GaussianBlur(picture, (0, 0), SMOOTHING_PX)
    contrast = cv2.convertScaleAbs(cv2.Laplacian(smooth, cv2.CV_16S), alpha=GAIN)
    cells = cv2.resize(contrast, (columns, rows), interpolation=cv2.INTER_AREA)
    busy = (cells > max(LEAST_BUSY, BUSY * float(np.median(cells)))).astype(np.uint8)
    joined = cv2.dilate(busy, np.ones((3, 3), np.uint8))
    count, _, boxes, _ = cv2.connectedComponentsWithStats(joined, connectivity=8)
    scale = np.array([width / columns, height / rows])
    return [_of_cells(boxes[number], scale) for number in range(1, count)]


def _of_cells(box: npt.NDArray[np.int32], scale: Floats) -> Window:
    left, top = np.floor(box[:2] * scale)
    right, bottom = np.ceil((box[:2] + box[2:4]) * scale)
    return Window(int(left), int(top), int(right), int(bottom))
