"""Finds the demonstrator's skirt in a frame and says where it is, how surely, or why it cannot say.

colour table -> patches -> those with a skirt's shape -> their edges -> range and bearing -> the one that the
demonstrator can be, by where it was last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from robot_agent.drivers.camera import Frame
from robot_agent.drivers.camera_formats import Words, frame_words, word_colours
from robot_agent.drivers.camera_model import CameraModel
from robot_agent.imitation.colour import SKIRT, ColourTable
from robot_agent.imitation.components import Blob, blobs_at_horizon, looks_like_skirt, looks_like_skirt_cut_off
from robot_agent.imitation.cylinder import (
    SKIRT_BOTTOM_M,
    SKIRT_RADIUS_M,
    SKIRT_TOP_M,
    Covariance,
    covariance,
    covariance_of_one_edge,
    half_angle_rad,
    range_and_bearing,
)
from robot_agent.imitation.edges import EdgeFinder
from robot_agent.imitation.gate import Gate, Place
from swarm.errors import UserError, nearest

MOUNTING_SD_RAD = math.radians(0.05)
MAX_CANDIDATES = 6
BORDER_PX = 5
"""An edge needs this much of the wall beside it."""
CLEARLY_NEARER = 0.5
DARK_LEVEL = 0.12
DARK_PERCENTILE = 90


class Reason(Enum):
    """Why a frame gives no sighting."""

    NOT_SEEN = "nothing of the skirt's colour at the horizon"
    UNLIKE = "nothing of the skirt's colour has the shape of a skirt"
    TWO_CANDIDATES = "two or more skirts could be the demonstrator's"
    CUT_OFF = "too little of the skirt is inside the image"
    HIDDEN = "something stands before the skirt or close beside it"
    JUMPED = "the skirt is where the demonstrator cannot have got to"
    DARK = "the image is dark"


@dataclass(frozen=True)
class Sighting:
    """The demonstrator's axis, seen from the camera; bearings are counter-clockwise from the camera's axis.

    `cut_off`: one side is outside the image (its column is then None), so the range comes from the skirt's
    height and is coarse; the covariance says so.
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
class Profile:
    """How edges are measured: to a fraction of a pixel, or as the border of the patch in whole pixels.

    `edge_sd_px` is the standard deviation of an edge's error, measured by tests/benchmarks/seeing.py.
    """

    width: int
    height: int
    sub_pixel: bool
    edge_sd_px: float


PROFILES = {
    "best": Profile(320, 240, sub_pixel=True, edge_sd_px=0.08),
    "paper": Profile(160, 120, sub_pixel=False, edge_sd_px=0.5),
}


class Seer:
    """Looks for one skirt in the frames of one camera, one frame after the other.

    `profile` is "best" (320 x 240, edges to a fraction of a pixel) or "paper" (160 x 120, size of the patch in
    whole pixels). The camera's model is taken at the profile's resolution.
    """

    def __init__(self, profile: str, model: CameraModel, table: ColourTable) -> None:
        if profile not in PROFILES:
            raise UserError(f"unknown profile {profile!r}; {nearest(profile, PROFILES)}")
        self.profile = PROFILES[profile]
        self.model = model.scaled(self.profile.width, self.profile.height)
        self._is_skirt = (table.kinds == SKIRT).astype(np.uint8)
        self._finder = EdgeFinder(self.model, table)
        self._brightness = word_colours().max(axis=1)
        self._gate = Gate()
        self._edge_sd_rad = self.profile.edge_sd_px / self.model.focal_px

    def reset(self) -> None:
        """Forget where the demonstrator was: a new observation begins."""
        self._gate.forget()

    def look(self, frame: Frame, turned_rad: float | None = None) -> Sighting | NotSeen:
        """What the frame shows of the demonstrator.

        `turned_rad`: how far the camera turned (counter-clockwise) since the frame before, which narrows
        down where the demonstrator can be; None if that is not known. UserError if the frame's size is not the
        profile's.
        """
        self._check_size(frame)
        self._gate.turn(turned_rad)
        words = frame_words(frame)
        if self._is_dark(words):
            return NotSeen(frame.t_ns, Reason.DARK)
        answer = self._choose(frame.t_ns, self._candidates(frame.t_ns, words))
        if isinstance(answer, Sighting):
            self._gate.keep(_place(answer))
            return answer
        return NotSeen(frame.t_ns, answer)

    def _check_size(self, frame: Frame) -> None:
        if (frame.width, frame.height) != (self.profile.width, self.profile.height):
            raise UserError(
                f"the camera gives {frame.width} x {frame.height} frames, the profile needs "
                f"{self.profile.width} x {self.profile.height}: set the camera to that size"
            )

    def _is_dark(self, words: Words) -> bool:
        sample = self._brightness[words[::8, ::8]]
        return bool(np.partition(sample.ravel(), -sample.size // 10)[-sample.size // 10] < DARK_LEVEL)

    def _candidates(self, t_ns: int, words: Words) -> list[Sighting | Reason]:
        """An answer for each patch of the skirt's colour, the largest first."""
        blobs = blobs_at_horizon(self._is_skirt[words], self.model)
        return [self._measure(t_ns, words, blob) for blob in blobs[:MAX_CANDIDATES]]

    def _measure(self, t_ns: int, words: Words, blob: Blob) -> Sighting | Reason:
        left_cut, right_cut = blob.left < BORDER_PX, blob.right > self.model.width - BORDER_PX
        if left_cut or right_cut:
            return self._measure_cut_off(t_ns, words, blob, left_cut, right_cut)
        if not looks_like_skirt(blob, self.model):
            return Reason.UNLIKE
        left, right = self._edges(words, blob)
        if left is None or right is None:
            return Reason.HIDDEN
        left_rad, right_rad = self.model.bearing_rad(left), self.model.bearing_rad(right)
        range_m, bearing_rad = range_and_bearing(left_rad, right_rad)
        spread = covariance(range_m, self._edge_sd_rad, MOUNTING_SD_RAD)
        return Sighting(t_ns, range_m, bearing_rad, spread, left, right)

    def _edges(self, words: Words, blob: Blob) -> tuple[float | None, float | None]:
        if not self.profile.sub_pixel:
            return blob.left - 0.5, blob.right - 0.5
        edges = self._finder.find(words, blob)
        return edges.left, edges.right

    def _measure_cut_off(
        self, t_ns: int, words: Words, blob: Blob, left_cut: bool, right_cut: bool
    ) -> Sighting | Reason:
        """One side is outside the image: range from the height, bearing from the other side."""
        if not looks_like_skirt_cut_off(blob, self.model):
            return Reason.CUT_OFF
        left, right = self._edges(words, blob)
        left, right = None if left_cut else left, None if right_cut else right
        edge = right if left is None else left
        if edge is None:
            return Reason.CUT_OFF
        side = -1 if left is None else 1
        middle_rad = self.model.bearing_rad((blob.left + blob.right - 1) / 2)
        depth_m = self.model.focal_px * (SKIRT_TOP_M - SKIRT_BOTTOM_M) / blob.height
        range_m = depth_m / math.cos(middle_rad) + SKIRT_RADIUS_M
        bearing_rad = self.model.bearing_rad(edge) - side * half_angle_rad(range_m)
        range_sd_m = range_m * 1.5 / blob.height
        spread = covariance_of_one_edge(range_m, range_sd_m, self._edge_sd_rad, MOUNTING_SD_RAD, side)
        return Sighting(t_ns, range_m, bearing_rad, spread, left, right, cut_off=True)

    def _choose(self, t_ns: int, candidates: list[Sighting | Reason]) -> Sighting | Reason:
        seen = [candidate for candidate in candidates if isinstance(candidate, Sighting)]
        if not seen:
            return next((candidate for candidate in candidates if isinstance(candidate, Reason)), Reason.NOT_SEEN)
        ranked = sorted((self._gate.strain(_place(sighting)), i) for i, sighting in enumerate(seen))
        if ranked[0][0] > 1:
            return Reason.JUMPED
        possible = [item for item in ranked if item[0] <= 1]
        if len(possible) > 1 and not self._gate.remembers(t_ns):
            return Reason.TWO_CANDIDATES
        if len(possible) > 1 and possible[0][0] > CLEARLY_NEARER * possible[1][0]:
            return Reason.TWO_CANDIDATES
        return seen[ranked[0][1]]


def _place(sighting: Sighting) -> Place:
    return Place(sighting.t_ns, sighting.range_m, sighting.bearing_rad, sighting.range_sd_m)
