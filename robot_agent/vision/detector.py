"""Finds the demonstrator's skirt in a frame and says where it is, how surely, or why it cannot say.

light -> patches of the skirt's colour in that light -> their edges -> range and bearing -> those with a
skirt's shape at that range, by a camera that may be tilted -> the one that the demonstrator can be, by where
it was last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import cv2
import numpy as np
from numpy.typing import NDArray

from robot_agent.vision.association import Association, Place
from robot_agent.vision.blobs import Blob, blobs_at_horizon
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Demonstrator
from robot_agent.vision.edges import Edge, EdgeFinder
from robot_agent.vision.frames import Frame
from robot_agent.vision.outline import Outline, lit_outline, outline
from robot_agent.vision.pixels import Words, frame_words, word_colours
from robot_agent.vision.skirt import (
    Covariance,
    SkirtShape,
    covariance,
    covariance_of_one_edge,
    half_angle_rad,
    range_and_bearing,
    sides_of_box,
)
from robot_agent.vision.skirt_colour import SkirtColour
from robot_agent.vision.tilt import Tilt
from robot_agent.vision.white_balance import WhiteBalance
from swarm.config.experiment import CopyProfile
from swarm.errors import UserError

MOUNTING_SD_RAD = math.radians(0.05)
"""Chosen: a camera's own yaw is calibrated to within this, a third of a pixel."""
SCALE_SD_PART = 0.004
"""Of the range; chosen: a skirt's radius is measured to 0.15 mm, or a lens's focal length to as much."""
MAX_CANDIDATES = 6
"""Chosen: bounds the work on a frame full of patches; a compartment holds one robot."""
BORDER_PX = 6
"""An edge needs this much of the wall beside it."""
CLEARLY_NEARER = 0.5
"""Chosen: the best candidate must fit where the demonstrator was twice as well as the next."""
MIN_WIDTH_PX = 4
"""Chosen: narrower than a skirt anywhere in the arena (15 pixels at 1.55 m, half at 160 x 120)."""
GROWN_PX = 0.7
"""How much higher than the skirt its pixels are: body and shadow do not bound it as white wall does."""
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
    row_px: float = 0.0
    """Of the skirt's middle."""

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
    `edge_sd_px` is the standard deviation of an edge's error at 320 pixels of width: a little more than
    tests/benchmarks/seeing.py finds, since real lamps are less even than the simulated ones.
    """

    width: int
    height: int
    sub_pixel: bool
    edge_sd_px: float
    tolerance_px: float
    height_sd_px: float
    """Of a skirt's height: body and shadow move a patch's borders, in its light less than in its pixels."""
    saturated_part: float
    """Of the skirt's saturation: with less, pixels of the wall beside it count, unevenly, as skirt; with
    more, noise takes pixels from it, which matters less where they are only counted."""


MEASUREMENTS = {
    CopyProfile.BEST: PatchMeasurement(
        320, 240, sub_pixel=True, edge_sd_px=0.1, tolerance_px=1.7, height_sd_px=0.7, saturated_part=0.38
    ),
    CopyProfile.PAPER: PatchMeasurement(
        160, 120, sub_pixel=False, edge_sd_px=0.25, tolerance_px=2.6, height_sd_px=1.5, saturated_part=0.45
    ),
}


def at_profile(profile: CopyProfile, model: CameraModel) -> CameraModel:
    """The camera at the resolution at which a profile takes its frames: "best" at the camera's own."""
    measurement = MEASUREMENTS[profile]
    return model if measurement.sub_pixel else model.scaled(measurement.width, measurement.height)


class Detector:
    """Looks for one demonstrator in the frames of one camera, one frame after the other.

    `profile` is "best" (edges to a fraction of a pixel, at the model's resolution) or "paper" (160 x 120,
    sides from the number of the patch's pixels). What it learns of the light and of the camera's tilt stays
    from one observation to the next.
    """

    def __init__(self, profile: CopyProfile, model: CameraModel, demonstrator: Demonstrator) -> None:
        self.profile = MEASUREMENTS[profile]
        self.model = at_profile(profile, model)
        self.tilt = Tilt(self.model)
        self._demonstrator = demonstrator
        light = (word_colours() ** self.model.gamma).astype(np.float32)
        self._white = WhiteBalance(self.model, light, demonstrator.white)
        self._colour = SkirtColour(demonstrator.skirt, light, self.profile.saturated_part)
        self._finder = EdgeFinder(self.model, demonstrator.skirt, light, self._colour)
        self._larger = max(1.0, self.model.width / 320)
        self._shape = SkirtShape(demonstrator.skirt, self.model, self.profile.tolerance_px * self._larger)
        self._association = Association()

    def reset(self) -> None:
        """Forget where the demonstrator was: a new observation begins."""
        self._association.forget()
        self.tilt.moved()

    def look(self, frame: Frame, turned_rad: float | None = None) -> Detection | NotSeen:
        """What the frame shows of the demonstrator.

        `turned_rad`: how far the camera turned (counter-clockwise) since the frame before, which narrows
        down where the demonstrator can be; None if that is not known. UserError if the frame's size is not
        the model's.
        """
        self._check_size(frame)
        self._association.turn(turned_rad)
        words = frame_words(frame)
        white = self._white.follow(words)
        if white.max() < DARK_LIGHT:
            return NotSeen(frame.t_ns, Reason.DARK)
        answer = self._choose(frame.t_ns, self._candidates(frame.t_ns, words, white))
        if isinstance(answer, Candidate):
            self._association.keep(_place(answer.detection))
            if not answer.detection.cut_off:
                self.tilt.learn(answer.column, answer.row_offset_px, answer.slope, answer.width_px)
            return answer.detection
        self.tilt.doubt()
        return NotSeen(frame.t_ns, answer)

    def _check_size(self, frame: Frame) -> None:
        if (frame.width, frame.height) != (self.model.width, self.model.height):
            raise UserError(
                f"the camera gives {frame.width} x {frame.height} frames, the profile needs "
                f"{self.model.width} x {self.model.height}: set the camera to that size"
            )

    def _candidates(self, t_ns: int, words: Words, white: NDArray[np.float64]) -> list[Candidate | Reason]:
        """An answer for each patch of the skirt's colour, the largest first."""
        mask = self._colour.table(white).take(words, mode="clip")
        if self.profile.sub_pixel:
            mask = np.asarray(cv2.medianBlur(mask, 3), dtype=np.uint8)
        blobs = blobs_at_horizon(mask, self.tilt.horizon_rows, self.tilt.slack_px(0.0))
        view = View(t_ns, words, mask, white)
        return [self._measure(view, blob) for blob in blobs[:MAX_CANDIDATES]]

    def _measure(self, view: View, blob: Blob) -> Candidate | Reason:
        covered = self._finder.is_covered(view.words, blob, view.white)
        if not blob.is_filled or (self._must_be_covered and not covered):
            return Reason.UNLIKE
        left_cut, right_cut = blob.left < BORDER_PX, blob.right > self.model.width - BORDER_PX
        if left_cut and right_cut:
            return Reason.CUT_OFF
        seen = self._outline(view, blob)
        left, right = self._edges(view, blob, seen, whole=not (left_cut or right_cut))
        left, right = None if left_cut else left, None if right_cut else right
        if left is not None and right is not None:
            return self._from_both_edges(view, seen, left, right, covered)
        if not (left_cut or right_cut) and _touches_its_like(view.mask, blob):
            return Reason.HIDDEN
        if (left is None and right is None) or not self._fits_part(blob, seen):
            return Reason.CUT_OFF if left_cut or right_cut else Reason.HIDDEN
        return self._from_one_edge(view, blob, seen, (left, right), covered)

    def _outline(self, view: View, blob: Blob) -> Outline:
        if self.profile.sub_pixel:
            return lit_outline(blob, view.mask, view.words, view.white, self._colour)
        seen = outline(blob, view.mask)
        return replace(seen, height_px=max(seen.height_px - GROWN_PX, 1.0))

    @property
    def _must_be_covered(self) -> bool:
        hat = self._demonstrator.hat
        return hat is not None and hat.stands_out

    def _edges(
        self, view: View, blob: Blob, seen: Outline, *, whole: bool
    ) -> tuple[Edge | None, Edge | None]:
        if self.profile.sub_pixel:
            return self._finder.find(view.words, blob, seen, view.white)
        left, right = self._shape.sides_by_size(blob) if whole else sides_of_box(blob)
        return Edge(left, seen.middle_row, 0.0), Edge(right, seen.middle_row, 0.0)

    def _bearings_rad(self, *edges: Edge) -> list[float]:
        columns, rows = [edge.column for edge in edges], [edge.row for edge in edges]
        return self.model.level_bearings_rad(columns, rows, self.tilt.pitch_rad, self.tilt.roll_rad)

    def _edge_sd_rad(self, *edges: Edge) -> float:
        variances = [edge.noise_sd_px**2 + (self.profile.edge_sd_px * self._larger) ** 2 for edge in edges]
        return math.sqrt(sum(variances) / len(edges)) / self.model.focal_px

    def _from_both_edges(
        self, view: View, seen: Outline, left: Edge, right: Edge, covered: bool
    ) -> Candidate | Reason:
        if right.column - left.column < MIN_WIDTH_PX:
            return Reason.UNLIKE
        radius_m = self._demonstrator.skirt.radius_m
        left_rad, right_rad = self._bearings_rad(left, right)
        range_m, bearing_rad = range_and_bearing(left_rad, right_rad, radius_m)
        depth_m = self._shape.depth_m(range_m, bearing_rad)
        column = (left.column + right.column) / 2
        if not self._fits(seen, depth_m, column):
            return Reason.UNLIKE
        spread = covariance(range_m, self._edge_sd_rad(left, right), MOUNTING_SD_RAD, radius_m)
        scaled = spread[0][0] + (SCALE_SD_PART * range_m) ** 2
        spread = ((scaled, 0.0), spread[1])
        columns = (left.column, right.column)
        detection = Detection(view.t_ns, range_m, bearing_rad, spread, *columns, row_px=seen.middle_row)
        offset_px = self._shape.row_offset_px(seen, depth_m)
        return Candidate(detection, covered, column, offset_px, seen.slope, right.column - left.column)

    def _fits(self, seen: Outline, depth_m: float, column: float) -> bool:
        return self._shape.fits(seen, depth_m, self.tilt.row_offset_px(column), self.tilt.slack_px(column))

    def _fits_part(self, blob: Blob, seen: Outline) -> bool:
        depth_m = self._shape.depth_from_height_m(seen)
        return self._shape.fits_part(blob, depth_m) and self._fits(
            seen, depth_m, (blob.left + blob.right - 1) / 2
        )

    def _from_one_edge(
        self, view: View, blob: Blob, seen: Outline, edges: tuple[Edge | None, Edge | None], covered: bool
    ) -> Candidate:
        """The range from the height of the patch, the bearing from the side that is seen."""
        radius_m = self._demonstrator.skirt.radius_m
        column = (blob.left + blob.right - 1) / 2
        depth_m = self._shape.depth_from_height_m(seen)
        range_m = depth_m / math.cos(self.model.bearing_rad(column)) + radius_m
        range_sd_m = range_m * self.profile.height_sd_px * self._larger / seen.height_px
        left, right = edges
        side, edge = (1, left) if left is not None else (-1, right)
        assert edge is not None
        bearing_rad = self._bearings_rad(edge)[0] - side * half_angle_rad(range_m, radius_m)
        edge_sd_rad = self._edge_sd_rad(edge)
        spread = covariance_of_one_edge(range_m, range_sd_m, edge_sd_rad, MOUNTING_SD_RAD, side, radius_m)
        columns = (left.column if left else None, right.column if right else None)
        measured = (view.t_ns, range_m, bearing_rad, spread, *columns)
        detection = Detection(*measured, cut_off=True, row_px=seen.middle_row)
        offset_px = self._shape.row_offset_px(seen, depth_m)
        return Candidate(detection, covered, column, offset_px, seen.slope, blob.width)

    def _choose(self, t_ns: int, candidates: list[Candidate | Reason]) -> Candidate | Reason:
        seen = [candidate for candidate in candidates if isinstance(candidate, Candidate)]
        if not seen:
            return next(
                (candidate for candidate in candidates if isinstance(candidate, Reason)), Reason.NOT_SEEN
            )
        ranked = sorted((self._association.strain(_place(one.detection)), i) for i, one in enumerate(seen))
        if ranked[0][0] > 1:
            return Reason.JUMPED
        possible = [item for item in ranked if item[0] <= 1]
        if len(possible) > 1 and not self._association.remembers(t_ns):
            return _the_covered_one([seen[number] for _, number in possible])
        if len(possible) > 1 and possible[0][0] > CLEARLY_NEARER * possible[1][0]:
            return _the_covered_one([seen[number] for _, number in possible])
        return seen[ranked[0][1]]


@dataclass(frozen=True)
class View:
    """What is looked at: a frame's pixels, those of the skirt's colour, and a white wall's light."""

    t_ns: int
    words: Words
    mask: NDArray[np.uint8]
    white: NDArray[np.float64]


@dataclass(frozen=True)
class Candidate:
    """A patch that can be the demonstrator's skirt, and what it would say of the camera's tilt."""

    detection: Detection
    covered: bool
    column: float
    row_offset_px: float
    slope: float
    width_px: float


def _the_covered_one(candidates: list[Candidate]) -> Candidate | Reason:
    """A robot has boards or a hat above its skirt, a post has the wall: the only one that has."""
    covered = [candidate for candidate in candidates if candidate.covered]
    return covered[0] if len(covered) == 1 else Reason.TWO_CANDIDATES


def _touches_its_like(mask: NDArray[np.uint8], blob: Blob) -> bool:
    """Whether something of the skirt's colour is right beside a patch, which may be part of it."""
    rows = slice(blob.top, blob.bottom)
    beside = (mask[rows, blob.left - 4 : blob.left - 1], mask[rows, blob.right + 1 : blob.right + 4])
    return any(columns.mean() > LIKE_PART for columns in beside)


def _place(detection: Detection) -> Place:
    return Place(detection.t_ns, detection.range_m, detection.bearing_rad, detection.range_sd_m)
