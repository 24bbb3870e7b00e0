"""How exactly and how fast robots with tags are found; run with `python -m tests.benchmarks.overhead`.

Prints a JSON line for each condition. The frames are rendered by `tracker_bridge.emulators.camera`, ray by
ray, without any of the tracker's code; lens and place come from rendered pictures of a board and of tags on
the floor. Times are processor time on one core, of OpenCV's own detector over the same full frames too.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import cv2
import numpy as np
import numpy.typing as npt

from swarm.geometry import wrap_angle_rad
from tests.support.overhead_scene import Conditions, OverheadScene
from tracker_bridge.emulators.camera.scene import Faults, TagPlate
from tracker_bridge.overhead.arena_view import ArenaView
from tracker_bridge.overhead.search import busy_windows
from tracker_bridge.overhead.tag_tracking import TagTracker
from tracker_bridge.overhead.tags import Tag, TagDetector, TagFamily

Grey = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

FALSE_M = 0.05
"""A tag said to be further from its robot is a false one."""
BOARDS = 15
SEARCHED_EACH = 10
"""Every tenth frame is also searched whole, by the tracker's search and by OpenCV."""

USUAL = Conditions()
FAULTS = Faults()
BEYOND: dict[str, Conditions] = {
    "usual": USUAL,
    "plain floor": replace(USUAL, is_littered=False),
    "noise 6": replace(USUAL, faults=replace(FAULTS, noise_levels=6.0)),
    "noise 12": replace(USUAL, faults=replace(FAULTS, noise_levels=12.0)),
    "defocus 1.0 px": replace(USUAL, faults=replace(FAULTS, defocus_px=1.0)),
    "defocus 1.4 px": replace(USUAL, faults=replace(FAULTS, defocus_px=1.4)),
    "exposure 20 ms": replace(USUAL, faults=replace(FAULTS, exposure_s=0.02)),
    "exposure 33 ms": replace(USUAL, faults=replace(FAULTS, exposure_s=0.033)),
    "darkest 0.1": replace(USUAL, faults=replace(FAULTS, darkest_light=0.1)),
    "rolling shutter 30 us": replace(USUAL, faults=replace(FAULTS, row_delay_s=3e-5)),
    "jpeg 50": replace(USUAL, faults=replace(FAULTS, jpeg_quality=50)),
    "tilt 3 degrees": replace(USUAL, tilt_sd_rad=math.radians(3)),
    "hidden 8 %": replace(USUAL, hidden=0.08),
    "hidden 16 %": replace(USUAL, hidden=0.16),
    "tag 50 mm": replace(USUAL, plate=TagPlate(side_m=0.05)),
    "tag 40 mm": replace(USUAL, plate=TagPlate(side_m=0.04)),
    "tag 30 mm": replace(USUAL, plate=TagPlate(side_m=0.03)),
    "50 robots": replace(USUAL, robots=50),
}
"""The first is the issue's; each other goes beyond it in one respect."""


class Tally:
    """Poses found and their errors, frames and processor time, of one way to find tags."""

    def __init__(self, view: ArenaView, plate: TagPlate, find: Callable[[Grey], list[Tag]]) -> None:
        self._view, self._plate, self._find = view, plate, find
        self.frames, self.robots, self.false, self.cpu_s = 0, 0, 0, 0.0
        self.errors_m: list[float] = []
        self.errors_rad: list[float] = []

    def take(self, picture: Grey, truth: Floats) -> None:
        began = time.process_time()
        tags = self._find(picture)
        quads = np.array([tag.corners for tag in tags]).reshape(-1, 4, 2)
        poses = self._view.level_poses(quads, self._plate.height_m, self._plate.side_m) if tags else []
        self.cpu_s += time.process_time() - began
        self.frames, self.robots = self.frames + 1, self.robots + len(truth)
        for tag, pose in zip(tags, poses, strict=True):
            error_m = math.inf
            if tag.id < len(truth):
                error_m = math.hypot(pose.x_m - truth[tag.id, 0], pose.y_m - truth[tag.id, 1])
            if error_m > FALSE_M:
                self.false += 1
                continue
            self.errors_m.append(error_m)
            self.errors_rad.append(abs(wrap_angle_rad(pose.theta_rad - truth[tag.id, 2])))

    def figures(self, name: str) -> dict[str, float]:
        position = np.percentile(self.errors_m or [math.nan], [50, 99, 100]) * 1e3
        heading = np.degrees(np.percentile(self.errors_rad or [math.nan], [50, 99, 100]))
        return {
            f"{name}_found": len(self.errors_m) / self.robots,
            f"{name}_false": self.false,
            f"{name}_frames_per_s": self.frames / self.cpu_s,
            **{f"{name}_position_mm_{part}": float(v) for part, v in zip(PARTS, position, strict=True)},
            **{f"{name}_heading_deg_{part}": float(v) for part, v in zip(PARTS, heading, strict=True)},
        }


PARTS = ("p50", "p99", "max")


def measure(conditions: Conditions, view: ArenaView, frames: int, seed: int) -> dict[str, float]:
    """Track a rendered video, and search every tenth of its frames whole."""
    scene = OverheadScene(conditions, TagFamily("36h11"), seed)
    detector = TagDetector(TagFamily("36h11", range(conditions.robots)))
    all_ids = TagDetector(TagFamily("36h11"))
    ways = {
        "tracking": TagTracker(detector).track,
        "search": lambda picture: detector.find(picture, busy_windows(picture)),
        "search_all_ids": lambda picture: all_ids.find(picture, busy_windows(picture)),
        "opencv": opencv_detector(),
    }
    tallies = {name: Tally(view, conditions.plate, find) for name, find in ways.items()}
    for number, (picture, truth) in enumerate(scene.frames(frames)):
        for name, tally in tallies.items():
            if name == "tracking" or number % SEARCHED_EACH == 0:
                tally.take(picture, truth)
    return {key: value for name, tally in tallies.items() for key, value in tally.figures(name).items()}


def opencv_detector() -> Callable[[Grey], list[Tag]]:
    """OpenCV's own detector with its usual parameters and corners refined below a pixel."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    detector = cv2.aruco.ArucoDetector(dictionary, parameters)

    def find(picture: Grey) -> list[Tag]:
        quads, ids, _ = detector.detectMarkers(picture)
        numbers = [] if ids is None else ids.ravel()
        return [
            Tag(int(number), np.asarray(quad, dtype=np.float64).reshape(4, 2))
            for quad, number in zip(quads, numbers, strict=True)
        ]

    return find


def lines(names: list[str], frames: int, seed: int) -> Iterator[str]:
    """The figures of some conditions; the camera is calibrated once, under the usual one."""
    view = OverheadScene(USUAL, TagFamily("36h11"), seed).calibrated_view(BOARDS)
    for name in names:
        figures = measure(BEYOND[name], view, frames, seed)
        rounded = {key: round(value, 4) for key, value in figures.items()}
        yield json.dumps(
            {"benchmark": "overhead", "condition": name, "frames": frames, "seed": seed, **rounded}
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--conditions", nargs="+", default=["usual"], choices=[*BEYOND, "all"])
    options = parser.parse_args()
    cv2.setNumThreads(1)
    names = list(BEYOND) if "all" in options.conditions else options.conditions
    for line in lines(names, options.frames, options.seed):
        print(line, flush=True)


if __name__ == "__main__":
    main()
