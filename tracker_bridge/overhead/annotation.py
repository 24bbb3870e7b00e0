"""Pictures with the tags that were found drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from swarm.files import new_file
from tracker_bridge.overhead.tags import Tag

Grey = npt.NDArray[np.uint8]
Colour = npt.NDArray[np.uint8]

SUBPIXEL_BITS = 4
"""OpenCV draws in sixteenths of a pixel then."""
OUTLINE, TOP_EDGE, TEXT = (0, 200, 0), (0, 0, 255), (0, 255, 255)
"""Blue, green, red."""


def annotated(picture: Grey, tags: Sequence[Tag]) -> Colour:
    """(height, width, 3): each tag's outline, its top edge in red, and its id."""
    colour = np.asarray(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
    for tag in tags:
        corners = np.rint(tag.corners * 2**SUBPIXEL_BITS).astype(np.int32)
        cv2.polylines(colour, [corners], True, OUTLINE, 1, cv2.LINE_AA, SUBPIXEL_BITS)
        cv2.polylines(colour, [corners[:2]], False, TOP_EDGE, 2, cv2.LINE_AA, SUBPIXEL_BITS)
        u, v = (int(part) for part in tag.corners.max(0))
        cv2.putText(colour, str(tag.id), (u + 2, v), cv2.FONT_HERSHEY_SIMPLEX, 0.45, TEXT, 1, cv2.LINE_AA)
    return colour


def save_picture(path: Path, picture: npt.NDArray[np.uint8]) -> None:
    """Write a new PNG file; UserError if it is there already."""
    with new_file(path) as file:
        file.write(cv2.imencode(".png", picture)[1].tobytes())
