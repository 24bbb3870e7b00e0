"""Finds the demonstrator's skirt in a frame and says where it is, how surely, or why it cannot say.

colour table -> patches -> those with a skirt's shape -> their edges -> range and bearing -> the one that the
demonstrator can be, by where it was last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from robot_agent.vision.association import Association, Place
from robot_agent.vision.blobs import Blob, blobs_at_horizon
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.colour_table import SKIRT, ColourTable
from robot_agent.vision.edges import EdgeFinder
from robot_agent.vision.frames import Frame
from robot_agent.vision.pixels import Words, frame_words
from robot_agent.vision.skirt import (
    SKIRT_RADIUS_M,
    TILT_RAD,
    Covariance,
    covariance,
    covariance_of_one_edge,
    depth_from_height_m,
    fits_part_of_skirt,
    fits_skirt,
    half_angle_rad,
    range_and_bearing,
    sides_by_size,
    sides_of_box,
)
from swarm.config.experiment import CopyProfile
from swarm.errors import UserError

MOUNTING_SD_RAD = math.radians(0.05)
"""Chosen: a camera's own yaw is calibrated to within this, a third of a pixel."""
MAX_CANDIDATES = 6
"""Chosen: bounds the work on a frame full of patches; a compartment holds one robot."""
BORDER_PX = 5
"""An edge needs this much of the wall beside it."""
CLEARLY_NEARER = 0.5
"""Chosen: the best candidate must fit where the demonstrator was twice as well as the next."""
HEIGHT_SD_PX = 1.5
"""Chosen: pitch, body and shadow move a patch's upper and lower border by a pixel or so each."""
MIN_WIDTH_PX = 4
"""Chosen: narrower than a skirt anywhere in the arena (15 pixels at 1.55 m, half at 160 x 120)."""
LIKE_PART = 0.15
"""Chosen: of the columns beside a patch; more of the skirt's colour there is another thing close by."""
DARK_LIGHT = 0.03
"""Of the sensor's full scale; chosen: a wall darker than this is unlit."""


class Reason(Enum):
    """Why a frame gives no detection."""

    NOT_SEEN = "nothing of the skirt's colour at the horizon"
    UNLIKE = "nothing of the skirt's colour has the shape of a skirt"
    TWO_CANDIDATES = "two or more skirts could be the demonstrator's"
    CUT_OFF = "too little of the skirt is inside the image"
    HIDDEN = "something stands before the skirt or close beside it"
    JUMPED = "the skirt is where the demonstrator cannot have got to"
    DARK = "the image is dark"


@dataclass(frozen=True)
class Detection:
    """The demonstrator's axis, seen from the camera; bearings are counter-clockwise from the camera's axis.

    `cut_off`: one side is outside the image or not against the wall (its column is then None), so the range
    comes from the skirt's height and is coarse; the covariance says so.
    """

    t_ns: int
    range_m: float
    bearing_rad: float
    covariance: Covariance
    left_px: float | None
    right_px: float | None
    cut_off: bool = False

    @property
    def range_sd_m(self) -> float:
        return math.sqrt(self.covariance[0][0])

    @property
    def bearing_sd_rad(self) -> float:
        return math.sqrt(self.covariance[1][1])


@dataclass(frozen=True)
class NotSeen:
    """A frame without an answer, and why."""

    t_ns: int
    reason: Reason


@dataclass(frozen=True)
class PatchMeasurement:
    """How a patch's sides are measured: to a fraction of a pixel, or from its size, the number of its pixels.

    `tolerance_px` is how far a patch's upper and lower border may be from where a skirt's would be.
    `edge_sd_px` is the standard deviation of an edge's error, measured by tests/benchmarks/seeing.py.
    """

    width: int
    height: int
    sub_pixel: bool
    edge_sd_px: float
    tolerance_px: float


MEASUREMENTS = {
    CopyProfile.BEST: PatchMeasurement(320, 240, sub_pixel=True, edge_sd_px=0.08, tolerance_px=1.7),
    CopyProfile.PAPER: PatchMeasurement(160, 120, sub_pixel=False, edge_sd_px=0.25, tolerance_px=2.6),
}


class Detector:
    """Looks for one skirt in the frames of one camera, one frame after the other.

    `profile` is "best" (320 x 240, edges to a fraction of a pixel) or "paper" (160 x 120, sides from the
    number of the patch's pixels). The camera's model is taken at the profile's resolution.
    """

    def __init__(self, profile: CopyProfile, model: CameraModel, table: ColourTable) -> None:
        self.profile = MEASUREMENTS[profile]
        self.model = model.scaled(self.profile.width, self.profile.height)
        self._is_skirt = (table.kinds == SKIRT).astype(np.uint8)
        self._finder = EdgeFinder(self.model, table)
        self._tolerance_px = self.profile.tolerance_px
        self._association = Association()
        self._edge_sd_rad = self.profile.edge_sd_px / self.model.focal_px

    def reset(self) -> None:
        """Forget where the demonstrator was: a new observation begins."""
        self._association.forget()

    def look(self, frame: Frame, turned_rad: float | None = None) -> Detection | NotSeen:
        """What the frame shows of the demonstrator.

        `turned_rad`: how far the camera turned (counter-clockwise) since the frame before, which narrows
        down where the demonstrator can be; None if that is not known. UserError if the frame's size is not
        the profile's.
        """
        self._check_size(frame)
        self._association.turn(turned_rad)
        words = frame_words(frame)
        wall_light = self._finder.wall_light(words)
        if wall_light < DARK_LIGHT:
            return NotSeen(frame.t_ns, Reason.DARK)
        answer = self._choose(frame.t_ns, self._candidates(frame.t_ns, words, wall_light))
        if isinstance(answer, Detection):
            self._association.keep(_place(answer))
            return answer
        return NotSeen(frame.t_ns, answer)

    def _check_size(self, frame: Frame) -> None:
        if (frame.width, frame.height) != (self.profile.width, self.profile.height):
            raise UserError(
                f"the camera gives {frame.width} x {frame.height} frames, the profile needs "
                f"{self.profile.width} x {self.profile.height}: set the camera to that size"
            )

    def _candidates(self, t_ns: int, words: Words, wall_light: float) -> list[Detection | Reason]:
        """An answer for each patch of the skirt's colour, the largest first."""
        mask = self._is_skirt.take(words, mode="clip")
        blobs = blobs_at_horizon(mask, self.model.horizon_row, TILT_RAD * self.model.focal_px)
        return [self._measure(t_ns, words, blob, wall_light) for blob in blobs[:MAX_CANDIDATES]]

    def _measure(self, t_ns: int, words: Words, blob: Blob, wall_light: float) -> Detection | Reason:
        if not (blob.is_filled and self._finder.has_body_above(words, blob, wall_light)):
            return Reason.UNLIKE
        left_cut, right_cut = blob.left < BORDER_PX, blob.right > self.model.width - BORDER_PX
        if left_cut and right_cut:
            return Reason.CUT_OFF
        whole = not (left_cut or right_cut)
        left, right = self._edges(words, blob, whole=whole)
        left, right = None if left_cut else left, None if right_cut else right
        if left is not None and right is not None:
            return self._from_both_edges(t_ns, blob, left, right)
        if not (left_cut or right_cut) and self._touches_its_like(words, blob):
            return Reason.HIDDEN
        if (left is None and right is None) or not fits_part_of_skirt(blob, self.model, self._tolerance_px):
            return Reason.CUT_OFF if left_cut or right_cut else Reason.HIDDEN
        return self._from_one_edge(t_ns, blob, left, right)

    def _touches_its_like(self, words: Words, blob: Blob) -> bool:
        """Whether something of the skirt's colour is right beside a patch, which may be part of it."""
        rows = slice(blob.top, blob.bottom)
        beside = (words[rows, blob.left - 4 : blob.left - 1], words[rows, blob.right + 1 : blob.right + 4])
        return any(self._is_skirt[columns].mean() > LIKE_PART for columns in beside)

    def _edges(self, words: Words, blob: Blob, *, whole: bool) -> tuple[float | None, float | None]:
        if not self.profile.sub_pixel:
            return sides_by_size(blob) if whole else sides_of_box(blob)
        edges = self._finder.find(words, blob)
        return edges.left, edges.right

    def _from_both_edges(self, t_ns: int, blob: Blob, left: float, right: float) -> Detection | Reason:
        if right - left < MIN_WIDTH_PX:
            return Reason.UNLIKE
        left_rad, right_rad = self.model.bearing_rad(left), self.model.bearing_rad(right)
        range_m, bearing_rad = range_and_bearing(left_rad, right_rad)
        if not fits_skirt(blob, self.model, range_m, bearing_rad, self._tolerance_px):
            return Reason.UNLIKE
        spread = covariance(range_m, self._edge_sd_rad, MOUNTING_SD_RAD)
        return Detection(t_ns, range_m, bearing_rad, spread, left, right)

    def _from_one_edge(self, t_ns: int, blob: Blob, left: float | None, right: float | None) -> Detection:
        """The range from the height of the patch, the bearing from the side that is seen."""
        middle_rad = self.model.bearing_rad((blob.left + blob.right - 1) / 2)
        range_m = depth_from_height_m(blob, self.model) / math.cos(middle_rad) + SKIRT_RADIUS_M
        range_sd_m = range_m * HEIGHT_SD_PX / blob.height
        side, edge = (1, left) if left is not None else (-1, right)
        assert edge is not None
        bearing_rad = self.model.bearing_rad(edge) - side * half_angle_rad(range_m)
        spread = covariance_of_one_edge(range_m, range_sd_m, self._edge_sd_rad, MOUNTING_SD_RAD, side)
        return Detection(t_ns, range_m, bearing_rad, spread, left, right, cut_off=True)

    def _choose(self, t_ns: int, candidates: list[Detection | Reason]) -> Detection | Reason:
        seen = [candidate for candidate in candidates if isinstance(candidate, Detection)]
        if not seen:
            return next(
                (candidate for candidate in candidates if isinstance(candidate, Reason)), Reason.NOT_SEEN
            )
        ranked = sorted((self._association.strain(_place(detection)), i) for i, detection in enumerate(seen))
        if ranked[0][0] > 1:
            return Reason.JUMPED
        possible = [item for item in ranked if item[0] <= 1]
        if len(possible) > 1 and not self._association.remembers(t_ns):
            return Reason.TWO_CANDIDATES
        if len(possible) > 1 and possible[0][0] > CLEARLY_NEARER * possible[1][0]:
            return Reason.TWO_CANDIDATES
        return seen[ranked[0][1]]


def _place(detection: Detection) -> Place:
    return Place(detection.t_ns, detection.range_m, detection.bearing_rad, detection.range_sd_m)
