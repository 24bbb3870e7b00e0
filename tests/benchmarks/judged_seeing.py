"""How well a demonstrator is seen by another renderer's light; `python -m tests.benchmarks.judged_seeing`.

Prints one JSON line: for each row of the judging renderer the share of frames with an answer, of frames with
a wrong one, and the mean normalised squared error of range and bearing (1 if the stated covariance is true).
The demonstrator is calibrated once, in plain light with a level and sharp camera, from a few frames in which
it stands anywhere in view; the rows then change what they change. docs/seeing.md publishes these figures.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CameraModel
from robot_agent.vision.demonstrator import Demonstrator, Skirt
from robot_agent.vision.detector import Detection, Detector, NotSeen
from robot_agent.vision.frames import Frame
from swarm.config.experiment import CopyProfile
from tests.support.judge.conditions import Condition, conditions
from tests.support.judge.demonstrations import random_view
from tests.support.judge.optics import Camera, Lens
from tests.support.judge.rendering import Truth, render, truth
from tests.support.judge.scene import Appearance

FOV_RAD, HEIGHT_M, FORWARD_M = 0.84, 0.028, 0.03
"""Of the camera's file: the field of view of Webots' e-puck, and its camera's place."""
CALIBRATION_FRAMES = 15
FRAMES_OF_A_RUN = 100
"""After so many frames the detector forgets the light and the tilt, as a new robot does."""
SKIRT_IN_THE_FILE = Appearance()
"""Rows with another radius than this have a file that is wrong about it."""


@dataclass(frozen=True)
class Judged:
    """What was true and what was said of one frame."""

    truth: Truth
    said: Detection | NotSeen

    @property
    def wrong(self) -> bool:
        """Whether an answer is not about the demonstrator: off by 10 % or 2 degrees and five deviations."""
        if isinstance(self.said, NotSeen):
            return False
        range_off_m = abs(self.said.range_m - self.truth.distance_m)
        bearing_off_rad = abs(self.said.bearing_rad - self.truth.bearing_rad)
        far = range_off_m > 0.1 * self.truth.distance_m + 5 * self.said.range_sd_m
        return far or bearing_off_rad > math.radians(2) + 5 * self.said.bearing_sd_rad

    @property
    def normalised_squared_error(self) -> float:
        """Half of the squared Mahalanobis distance in range and bearing."""
        assert isinstance(self.said, Detection)
        off = np.array(
            [self.said.range_m - self.truth.distance_m, self.said.bearing_rad - self.truth.bearing_rad]
        )
        return float(off @ np.linalg.solve(np.array(self.said.covariance), off)) / 2


def camera_of(condition: Condition) -> Camera:
    return condition.camera(FOV_RAD, HEIGHT_M, FORWARD_M)


def file_of(condition: Condition) -> CameraModel:
    """What the camera's file says: a level camera with the plain row's lens, whatever the row's camera is."""
    k1, k2 = Lens().k1, Lens().k2
    border = math.tan(FOV_RAD / 2)
    roots = np.roots([k2, 0.0, k1, 0.0, 1.0, -border] if k2 else [k1, 0.0, 1.0, -border])
    slope = min(float(root.real) for root in roots if abs(root.imag) < 1e-9 and root.real > 0)
    size = (condition.width, condition.height)
    radial, gamma = (k1, k2), condition.sensor.gamma
    return CameraModel(*size, 2 * math.atan(slope), radial, 0.5, gamma, FORWARD_M, HEIGHT_M)


def calibrated(condition: Condition, seed: int) -> Demonstrator:
    """Learnt from the row's robot in plain light, by a level camera, anywhere in view."""
    plain = conditions()["black hat"]
    appearance = replace(condition.appearance, skirt_radius_m=SKIRT_IN_THE_FILE.skirt_radius_m)
    laboratory = replace(plain, appearance=appearance, width=condition.width, height=condition.height)
    generator = np.random.default_rng([seed, 1])
    frames = [frame for frame, _ in views(laboratory, CALIBRATION_FRAMES, generator)]
    look = SKIRT_IN_THE_FILE
    skirt = Skirt("red", look.skirt_radius_m, look.skirt_bottom_m, look.skirt_top_m)
    return learn_demonstrator(frames, file_of(condition), skirt).demonstrator


def views(condition: Condition, count: int, generator: np.random.Generator) -> Iterator[tuple[Frame, Truth]]:
    """Frames of the robot somewhere in random rooms."""
    camera = camera_of(condition)
    for _ in range(count):
        observer, robot = random_view(generator, camera)
        scene = condition.scene(robot, generator)
        data = render(scene, observer, camera, condition.sensor, generator)
        frame = Frame(0, condition.width, condition.height, condition.sensor.pixel_format, data)
        yield frame, truth(scene, observer, camera)


def judged(condition: Condition, count: int, seed: int) -> list[Judged]:
    """Each frame by itself, except for the light and the tilt, which stay those of the run."""
    demonstrator, model = calibrated(condition, seed), file_of(condition)
    generator = np.random.default_rng([seed, 2])
    answers = []
    for number, (frame, true) in enumerate(views(condition, count, generator)):
        if number % FRAMES_OF_A_RUN == 0:
            detector = Detector(CopyProfile.BEST, model, demonstrator)
        detector.reset()
        answers.append(Judged(true, detector.look(frame)))
    return answers


def score(condition: Condition, count: int, seed: int) -> dict[str, object]:
    """The figures of one row; a robot that is half hidden in the picture need not be seen."""
    answers = judged(condition, count, seed)
    visible = [one for one in answers if one.truth.visible_fraction > 0.9]
    seen = [one for one in answers if isinstance(one.said, Detection)]
    right = [one for one in seen if not one.wrong]
    reasons = Counter(one.said.reason.name for one in visible if isinstance(one.said, NotSeen))
    errors = [one.normalised_squared_error for one in right]
    bias = [_range_off_part(one) for one in right]
    return {
        "answered": round(sum(isinstance(one.said, Detection) for one in visible) / len(visible), 4),
        "by_both_edges": round(sum(not _cut_off(one.said) for one in visible) / len(visible), 4),
        "wrong": round(sum(one.wrong for one in answers) / len(answers), 4),
        "nees": round(float(np.mean(errors)), 3) if errors else None,
        "range_bias_part": round(float(np.mean(bias)), 4) if bias else None,
        "unseen": dict(reasons),
    }


def _cut_off(said: Detection | NotSeen) -> bool:
    return isinstance(said, NotSeen) or said.cut_off


def _range_off_part(one: Judged) -> float:
    assert isinstance(one.said, Detection)
    return one.said.range_m / one.truth.distance_m - 1


def main() -> None:
    rows = conditions()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rows", nargs="+", default=list(rows), choices=list(rows))
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    scores = {name: score(rows[name], arguments.frames, arguments.seed) for name in arguments.rows}
    settings = {"frames": arguments.frames, "seed": arguments.seed}
    print(json.dumps({"benchmark": "judged_seeing", **settings, "rows": scores}))


if __name__ == "__main__":
    main()
