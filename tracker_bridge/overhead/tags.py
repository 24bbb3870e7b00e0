"""Printed tags in pictures: ArUco and AprilTag markers.

OpenCV proposes quadrilaterals; their edges are then found to a fraction of a pixel, and their codes are read
from there. At three pixels a module that reads tags which OpenCV's own reading, from the corners of a
contour's pixels, rejects.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from swarm.errors import UserError, nearest
from tracker_bridge.overhead.codes import CodeBook
from tracker_bridge.overhead.edges import aligned_quads
from tracker_bridge.overhead.search import Window

Floats = npt.NDArray[np.float64]
Grey = npt.NDArray[np.uint8]

FAMILIES: dict[str, int] = {
    name.removeprefix("DICT_").removeprefix("APRILTAG_").lower(): number
    for name, number in vars(cv2.aruco).items()
    if name.startswith("DICT_")
}
"""OpenCV's dictionaries by short name: 36h11, 4x4_50, ..."""
SMALLEST_SIDE_PX = 6
"""A 36h11 has then less than one pixel a module: nothing smaller can be read."""
CONTOUR_ERROR_PX = 1.5
"""OpenCV's corners are a contour's pixels; the true edge lies so near."""

SAME_QUAD = 0.05
"""Quads nearer to each other than this part of their size are one. OpenCV's own, larger value keeps the
outermost of nested ones: often the white paper around a tag, and not the tag."""


@dataclass(frozen=True)
class Tag:
    """A tag in a picture. Corners are (4, 2) pixels (the middle of the first is (0, 0)), clockwise from the
    printed tag's upper left."""

    id: int
    corners: Floats
    agreement: float = 1.0
    """Correlation of what is seen with the tag's code."""


class TagFamily:
    """A dictionary of tags, cut down to the ids that a laboratory uses: others are never reported.

    Raises UserError for a family that OpenCV does not know and for ids that the family does not have.
    """

    def __init__(self, name: str, allowed: Iterable[int] | None = None) -> None:
        if name.lower() not in FAMILIES:
            raise UserError(f"no family of tags is named {name!r}; {nearest(name.lower(), FAMILIES)}")
        whole = cv2.aruco.getPredefinedDictionary(FAMILIES[name.lower()])
        size = len(whole.bytesList)
        self.name = name
        self.ids = sorted(set(range(size) if allowed is None else allowed))
        beyond = [tag for tag in self.ids if not 0 <= tag < size]
        if beyond or not self.ids:
            raise UserError(f"the family {name} has the ids 0 to {size - 1}; asked for {beyond or 'none'}")
        self.dictionary = whole
        self.modules = whole.markerSize + 2
        """Modules along a side, the black border included."""

    def code(self, tag: int) -> Grey:
        """(modules, modules): 1 where the printed tag is white."""
        picture = self.dictionary.generateImageMarker(tag, self.modules)
        return np.asarray(picture > 0, dtype=np.uint8)

    @property
    def least_agreement(self) -> float:
        """What a reading must reach: more than random modules do with any code of the family.

        Of k random modules the correlation with one code has a standard deviation of 1 / sqrt(k): six of
        them at 6 x 6 modules are 0.88 with the blur's share; with fewer modules nearly all must agree.
        """
        return min(0.93, 0.88 * 6 / (self.modules - 2))


class TagDetector:
    """Finds tags in grey pictures, each corner to a fraction of a pixel."""

    def __init__(self, family: TagFamily) -> None:
        self.family = family
        self.book = CodeBook(np.array([family.code(tag) for tag in family.ids]))
        self._detector = _proposer(family.dictionary)

    def find(self, picture: Grey, windows: Sequence[Window] | None = None) -> list[Tag]:
        """The tags of a picture, or of windows of it."""
        whole = [Window(0, 0, picture.shape[1], picture.shape[0])]
        quads = [self._proposed(picture, window) for window in (whole if windows is None else windows)]
        return self._read(picture, np.concatenate(quads)) if quads else []

    def _proposed(self, picture: Grey, window: Window) -> Floats:
        """(n, 4, 2): clockwise quadrilaterals of a window, in the picture's pixels."""
        part = picture[window.top : window.bottom, window.left : window.right]
        parameters = self._detector.getDetectorParameters()
        parameters.minMarkerPerimeterRate = 4 * SMALLEST_SIDE_PX / max(part.shape)
        self._detector.setDetectorParameters(parameters)
        read, _, rejected = self._detector.detectMarkers(part)
        quads = np.array([*read, *rejected], dtype=np.float64).reshape(-1, 4, 2)
        return np.asarray(quads + np.array([window.left, window.top]))

    def _read(self, picture: Grey, quads: Floats) -> list[Tag]:
        if not len(quads):
            return []
        quads = aligned_quads(picture, quads, CONTOUR_ERROR_PX, self.family.modules)
        numbers, rolls, agreement = self.book.read(picture, quads)
        tags: list[Tag] = []
        for best in np.argsort(-agreement):
            if agreement[best] < self.family.least_agreement:
                break
            corners = np.roll(quads[best], rolls[best], 0)
            tag = Tag(self.family.ids[int(numbers[best])], corners, float(agreement[best]))
            if not any(_overlap(tag, other) for other in tags):
                tags.append(tag)
        return tags


def _proposer(dictionary: cv2.aruco.Dictionary) -> cv2.aruco.ArucoDetector:
    """OpenCV's detector for what it does before it reads. It reads all the same: one code will do."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.minGroupDistance = parameters.minMarkerDistanceRate = SAME_QUAD
    one = cv2.aruco.Dictionary(dictionary.bytesList[:1], dictionary.markerSize, 0)
    return cv2.aruco.ArucoDetector(one, parameters)


def _overlap(tag: Tag, other: Tag) -> bool:
    """Whether two readings are of one print: their middles lie within half a side of an equal square."""
    apart = np.linalg.norm(tag.corners.mean(0) - other.corners.mean(0))
    return bool(apart < np.sqrt(cv2.contourArea(tag.corners.astype(np.float32))) / 2)
