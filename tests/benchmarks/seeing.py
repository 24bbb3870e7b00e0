"""How exactly a demonstrator is seen, on rendered frames; run with `python -m tests.benchmarks.seeing`.

Prints one JSON line. `answered` counts frames in which the whole demonstrator is in view; errors are against
the truth that was rendered. Wrong blobs are counted along drives between two posts of the skirt's own colour.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Post, Rectangle, Scene, SceneRobot
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CameraModel, load_camera_model
from robot_agent.vision.demonstrator import SKIRT_RADIUS_M, Skirt
from robot_agent.vision.detector import MEASUREMENTS, Detection, Detector, NotSeen
from robot_agent.vision.frames import Frame
from robot_agent.vision.skirt import half_angle_rad
from swarm.config.experiment import CopyProfile
from swarm.geometry import Pose

CALIBRATION = Path(__file__).parents[2] / "deploy" / "cameras" / "epuck_320x240.toml"
ROOMS = (Rectangle(0.0, 0.0, 1.2, 1.2), Rectangle(1.2, 0.0, 2.4, 1.2))
CALIBRATION_RANGES_M = (0.25, 0.3, 0.4)
FRAMES_OF_A_CAMERA = 100
FRAME_NS = 200_000_000
OBSERVER = (1.18, 0.02)


@dataclass(frozen=True)
class Look:
    """What was true and what was said of one frame."""

    range_m: float
    bearing_rad: float
    width_px: float
    said: Detection | NotSeen


def make_pair(
    profile: CopyProfile, condition: str, skirt: str, seed: int, pixel_format: str = "rgb565"
) -> tuple[SimulatedCamera, Detector]:
    """A camera and a detector whose colour table was learnt with that camera."""
    model = load_camera_model(CALIBRATION).scaled(MEASUREMENTS[profile].width, MEASUREMENTS[profile].height)
    rng = np.random.default_rng(seed)
    camera = SimulatedCamera(model, conditions(condition), rng, pixel_format)
    frames = calibration_frames(camera, skirt, CALIBRATION_RANGES_M)
    return camera, Detector(profile, model, learn_demonstrator(frames, model, Skirt(skirt)).demonstrator)


def in_view(model: CameraModel, own: Pose, body: Pose, margin_px: float = 8.0) -> bool:
    """Whether both sides of the skirt, and some wall beside them, are inside the image."""
    place = model.pose(own).relative(body)
    range_m, bearing_rad = math.hypot(place.x_m, place.y_m), math.atan2(place.y_m, place.x_m)
    half_rad = half_angle_rad(range_m)
    left, right = model.column(bearing_rad + half_rad), model.column(bearing_rad - half_rad)
    return place.x_m > 0 and left > margin_px and right < model.width - 1 - margin_px


def look_at(
    camera: SimulatedCamera, detector: Detector, own: Pose, scene: Scene, t_ns: int, turn_rad_s: float
) -> Look:
    """Render the scene, whose first body is the demonstrator, and look for it."""
    model = camera.model
    place = model.pose(own).relative(scene.bodies[0].pose)
    range_m, bearing_rad = math.hypot(place.x_m, place.y_m), math.atan2(place.y_m, place.x_m)
    half_rad = half_angle_rad(range_m)
    width_px = model.column(bearing_rad - half_rad) - model.column(bearing_rad + half_rad)
    said = detector.look(camera.render(t_ns, own, scene, turn_rad_s))
    return Look(range_m, bearing_rad, width_px, said)


def scattered(
    profile: CopyProfile, condition: str, skirt: str, frames: int, seed: int, pixel_format: str = "rgb565"
) -> Iterator[Look]:
    """Single frames: the demonstrator at 40 to 150 cm, at rest or moving, with another robot and a post."""
    for first in range(0, frames, FRAMES_OF_A_CAMERA):
        camera, detector = make_pair(profile, condition, skirt, seed + first, pixel_format)
        rng = np.random.default_rng([seed, first])
        for _ in range(min(FRAMES_OF_A_CAMERA, frames - first)):
            detector.reset()
            own, scene = random_scene(camera.model, skirt, rng)
            yield look_at(camera, detector, own, scene, 0, float(rng.uniform(-0.2, 0.2)))


def random_scene(model: CameraModel, skirt: str, rng: np.random.Generator) -> tuple[Pose, Scene]:
    """An observer near the corner and a demonstrator wholly in its view, which nothing hides."""
    while True:
        own = Pose(1.2 - rng.uniform(0.0, 0.06), rng.uniform(0.0, 0.06), rng.uniform(1.6, 3.1))
        body = Pose(rng.uniform(0.06, 1.14), rng.uniform(0.06, 1.14), rng.uniform(-3, 3))
        range_m = model.pose(own).distance_m(body)
        if not (0.4 <= range_m <= 1.5 and in_view(model, own, body)):
            continue
        speed_m_s, course_rad = rng.choice([0.0, 0.1]), rng.uniform(-3, 3)
        velocity = (float(speed_m_s * math.cos(course_rad)), float(speed_m_s * math.sin(course_rad)))
        other = Pose(rng.uniform(0.06, 1.14), rng.uniform(0.06, 1.14), 0.0)
        post = Post(float(rng.uniform(0.03, 1.17)), 1.17, "orange")
        if _apart(model, own, body, (other, Pose(post.x_m, post.y_m, 0.0))):
            others = (SceneRobot(other, "blue" if skirt != "blue" else "red"),)
            return own, Scene(ROOMS, (SceneRobot(body, skirt, velocity), *others), (post,))


def _apart(model: CameraModel, own: Pose, body: Pose, others: tuple[Pose, ...]) -> bool:
    """Whether nothing stands before the body or seems to touch it."""
    camera = model.pose(own)
    for other in others:
        at, beside = camera.relative(body), camera.relative(other)
        gap_rad = abs(math.atan2(at.y_m, at.x_m) - math.atan2(beside.y_m, beside.x_m))
        away_m = math.hypot(beside.x_m, beside.y_m)
        room_rad = half_angle_rad(math.hypot(at.x_m, at.y_m)) + half_angle_rad(max(away_m, 0.05)) + 0.04
        if gap_rad < room_rad:
            return False
    return True


def driving(
    profile: CopyProfile, condition: str, skirt: str, frames: int, seed: int, twins: int
) -> Iterator[Look]:
    """Drives at 10 cm/s and 5 frames a second among posts of the skirt's colour, the observer turning."""
    number = 0
    while number < frames:
        camera, detector = make_pair(profile, condition, skirt, seed + number)
        rng = np.random.default_rng([seed, number])
        path = list(drive(rng))
        posts = tuple(twin_post(skirt, path, rng) for _ in range(twins))
        for step, body in enumerate(path):
            own = Pose(
                *OBSERVER, math.atan2(body.y_m - OBSERVER[1], body.x_m - OBSERVER[0]) + rng.uniform(-0.1, 0.1)
            )
            scene = Scene(ROOMS, (SceneRobot(body, skirt),), posts)
            yield look_at(camera, detector, own, scene, step * FRAME_NS, 0.0)
            number += 1


def twin_post(skirt: str, path: list[Pose], rng: np.random.Generator) -> Post:
    """A post of the skirt's colour and of any likely size that stands in nobody's way."""
    while True:
        x_m, y_m = rng.uniform(0.03, 1.17, 2)
        clear_m = min(math.hypot(x_m - pose.x_m, y_m - pose.y_m) for pose in path)
        if clear_m > 0.08 and math.hypot(x_m - OBSERVER[0], y_m - OBSERVER[1]) > 0.2:
            return Post(float(x_m), float(y_m), skirt, rng.uniform(0.008, 0.03), rng.uniform(0.03, 0.12))


def drive(rng: np.random.Generator) -> Iterator[Pose]:
    """The demonstrator at each frame of five moves, with rests between them."""
    column, row = (int(number) for number in rng.integers(0, 7, 2))
    x_m, y_m = 0.06 + 0.12 * column, 1.14 - 0.12 * row
    for _ in range(5):
        east, south = ((1, 1), (1, 0), (0, 1), (-1, 1), (0, -1))[int(rng.integers(5))]
        if not (0.05 < x_m + 0.12 * east < 1.0 and 0.2 < y_m - 0.12 * south < 1.15):
            continue
        pieces = math.ceil(6 * math.hypot(east, south))
        for piece in range(1, pieces + 3):
            part = min(piece, pieces) / pieces
            yield Pose(x_m + part * 0.12 * east, y_m - part * 0.12 * south, 0.0)
        x_m, y_m = x_m + 0.12 * east, y_m - 0.12 * south


def accuracy(looks: list[Look], model: CameraModel) -> dict[str, float]:
    """The figures that the issue names, from frames that got an answer."""
    pairs = [
        (look, look.said) for look in looks if isinstance(look.said, Detection) and not look.said.cut_off
    ]
    ranges = np.array([look.range_m for look, _ in pairs])
    range_errors = np.array([said.range_m - look.range_m for look, said in pairs])
    bearing_errors = np.array([said.bearing_rad - look.bearing_rad for look, said in pairs])
    widths = np.array([(said.right_px or 0) - (said.left_px or 0) - look.width_px for look, said in pairs])
    gross = np.abs(widths) > 3
    px_m = ranges**2 / (2 * model.focal_px * SKIRT_RADIUS_M)
    return {
        "answered": sum(isinstance(look.said, Detection) for look in looks) / len(looks),
        "answered_by_both_edges": len(pairs) / len(looks),
        "gross_errors": float(gross.mean()),
        "width_sd_px": float(widths.std()),
        "width_bias_px": float(widths.mean()),
        "range_k_per_cm": float((range_errors / ranges**2).std() / 100),
        "range_bias_of_bound": float(np.max(_bin_bias(ranges, range_errors, px_m))),
        "bearing_sd_deg": math.degrees(float(bearing_errors.std())),
        "bearing_bias_deg": math.degrees(float(bearing_errors.mean())),
        "range_error_of_sd": float(
            np.std([e / s.range_sd_m for e, (_, s) in zip(range_errors, pairs, strict=True)])
        ),
        "bearing_error_of_sd": float(
            np.std([e / s.bearing_sd_rad for e, (_, s) in zip(bearing_errors, pairs, strict=True)])
        ),
    }


def _bin_bias(ranges: np.ndarray, errors: np.ndarray, px_m: np.ndarray) -> list[float]:
    """Bias over its bound (0.5 % of the range and 0.05 px of width), in bins of range."""
    bins = np.digitize(ranges, [0.6, 0.8, 1.0, 1.2, 1.35])
    return [
        abs(errors[bins == number].mean())
        / (0.005 * ranges[bins == number] + 0.05 * px_m[bins == number]).mean()
        for number in range(6)
        if np.any(bins == number)
    ]


def is_wrong(look: Look) -> bool:
    """Whether an answer is not about the demonstrator."""
    said = look.said
    if isinstance(said, NotSeen):
        return False
    off_range = abs(said.range_m - look.range_m) > 0.1 * look.range_m + 5 * said.range_sd_m
    return off_range or abs(said.bearing_rad - look.bearing_rad) > math.radians(2) + 5 * said.bearing_sd_rad


def cost_ms(profile: CopyProfile, skirt: str, frames: int) -> float:
    """Processor time of a look: the shortest for each of some frames (other processes disturb the rest)."""
    camera, detector = make_pair(profile, "realistic", skirt, 1)
    rng = np.random.default_rng(2)
    images: list[Frame] = []
    for _ in range(10):
        own, scene = random_scene(camera.model, skirt, rng)
        images.append(camera.render(0, own, scene))
    best = [math.inf] * len(images)
    for _ in range(frames):
        for number, image in enumerate(images):
            detector.reset()
            start = time.process_time()
            detector.look(image)
            best[number] = min(best[number], time.process_time() - start)
    return 1e3 * sum(best) / len(best)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--profile", type=CopyProfile, default=CopyProfile.BEST, choices=list(CopyProfile))
    parser.add_argument("--conditions", default="realistic")
    parser.add_argument("--skirt", default="red")
    parser.add_argument("--format", default="rgb565")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    cv2.setNumThreads(1)
    chosen = (options.profile, options.conditions, options.skirt, options.frames, options.seed)
    looks = list(scattered(*chosen, options.format))
    model = load_camera_model(CALIBRATION).scaled(
        MEASUREMENTS[options.profile].width, MEASUREMENTS[options.profile].height
    )
    drives = list(driving(*chosen, twins=2))
    figures = {
        "benchmark": "seeing",
        **vars(options),
        **accuracy(looks, model),
        "twins_wrong": sum(is_wrong(look) for look in drives) / len(drives),
        "twins_answered": sum(isinstance(look.said, Detection) for look in drives) / len(drives),
        "ms_a_frame": cost_ms(options.profile, options.skirt, 20),
    }
    print(json.dumps({name: round(v, 7) if isinstance(v, float) else v for name, v in figures.items()}))


if __name__ == "__main__":
    main()
