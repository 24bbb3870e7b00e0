"""An emulated overhead camera with a swarm below it, and its calibration as a laboratory would find it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from tracker_bridge.emulators.camera.calibration import (
    BOARD_SQUARES,
    SQUARE_M,
    board_pictures,
    floor_picture,
)
from tracker_bridge.emulators.camera.floor import littered_floor, plain_floor
from tracker_bridge.emulators.camera.optics import Optics, Station
from tracker_bridge.emulators.camera.renderer import CameraRenderer
from tracker_bridge.emulators.camera.scene import Faults, Swarm, TagPlate
from tracker_bridge.emulators.camera.true_view import true_view
from tracker_bridge.emulators.wandering import WanderingSwarm
from tracker_bridge.overhead.arena_view import ArenaView, corners_of_known_tags, view_from_known_points
from tracker_bridge.overhead.lens import Board, find_lens
from tracker_bridge.overhead.tags import TagDetector, TagFamily

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

ARENA_SIDE_M = 3.0
FRAMES_PER_S = 30
FLOOR_TAGS = {
    500: (0.3, 0.3, 0.0),
    501: (2.7, 0.3, 1.0),
    502: (2.7, 2.7, 2.0),
    503: (0.3, 2.7, 3.0),
    504: (1.5, 1.5, -1.0),
    505: (1.5, 0.4, 0.5),
}
FLOOR_SIDE_M = 0.1


@dataclass(frozen=True)
class Conditions:
    """What is varied: the first are the issue's, the rest go beyond."""

    faults: Faults = field(default_factory=Faults)
    plate: TagPlate = field(default_factory=TagPlate)
    robots: int = 20
    is_littered: bool = True
    tilt_sd_rad: float = math.radians(0.5)
    """Plates are glued by hand."""
    hidden: float = 0.0
    """The part of every plate that something covers."""


class OverheadScene:
    """A camera over wandering robots that wear the tags 0, 1, 2, ... of a family."""

    def __init__(
        self, conditions: Conditions, family: TagFamily, seed: int, optics: Optics | None = None
    ) -> None:
        self.conditions, self.family = conditions, family
        self._rng = np.random.default_rng(seed)
        self.optics = optics or Optics()
        floor = (littered_floor if conditions.is_littered else plain_floor)(self.optics, self._rng)
        codes = {tag: family.code(tag) for tag in range(conditions.robots)}
        self.camera = CameraRenderer(
            self.optics, Station(), conditions.plate, conditions.faults, codes, floor, self._rng
        )

    def frames(self, count: int) -> Iterator[tuple[Grey, Floats]]:
        """Pictures at 30 frames/s, each with the robots' true poses (n, 3) in the middle of its exposure."""
        conditions, gap_m = self.conditions, 2 * self.conditions.plate.half_m * math.sqrt(2)
        swarm = WanderingSwarm(conditions.robots, ARENA_SIDE_M, gap_m, self._rng)
        tilts_rad = self._rng.normal(0, conditions.tilt_sd_rad, (conditions.robots, 2))
        hidden = np.full(conditions.robots, conditions.hidden)
        ids = tuple(range(conditions.robots))
        for _ in range(count):
            for _ in range(4):
                swarm.step(1 / FRAMES_PER_S / 4)
            yield (
                self.camera.render(Swarm(ids, swarm.poses, swarm.velocities, tilts_rad, hidden)),
                swarm.poses.copy(),
            )

    def true_view(self) -> ArenaView:
        """The camera as it is."""
        return true_view(self.camera)

    def calibrated_view(self, boards: int) -> ArenaView:
        """The camera as calibration finds it: its lens from a board, its place from tags on the floor."""
        board = Board(BOARD_SQUARES, BOARD_SQUARES, SQUARE_M)
        lens = find_lens(board_pictures(self.camera, boards, self._rng), board)
        whole = TagFamily(self.family.name, FLOOR_TAGS)
        codes = {tag: whole.code(tag) for tag in FLOOR_TAGS}
        picture = floor_picture(self.camera, codes, np.array(list(FLOOR_TAGS.values())), FLOOR_SIDE_M)
        poses = {tag: (x_m, y_m, 0.0, theta) for tag, (x_m, y_m, theta) in FLOOR_TAGS.items()}
        places_m, seen = corners_of_known_tags(poses, FLOOR_SIDE_M), TagDetector(whole).find(picture)
        return view_from_known_points(
            lens,
            np.concatenate([places_m[tag.id] for tag in seen]),
            np.concatenate([tag.corners for tag in seen]),
        )
