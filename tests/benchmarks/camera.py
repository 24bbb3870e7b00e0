"""What a rendered frame costs; run with `python -m tests.benchmarks.camera`. Prints one JSON line.

Milliseconds of processor time a frame, the shortest of many: other processes disturb the rest.
"""

from __future__ import annotations

import json
import math
import time

import cv2
import numpy as np

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Post, Rectangle, Scene, SceneRobot
from robot_agent.vision.camera_model import load_camera_model
from swarm.geometry import Pose
from tests.benchmarks.seeing import CALIBRATION

OBSERVER = Pose(1.14, 0.06, math.radians(135))
ROOMS = (Rectangle(0.0, 0.0, 1.2, 1.2), Rectangle(1.2, 0.0, 2.4, 1.2))
SCENE = Scene(
    ROOMS,
    (SceneRobot(Pose(0.8, 0.4, 0.0), "red", (0.1, 0.0)), SceneRobot(Pose(0.3, 0.65, 0.0), "blue")),
    (Post(0.3, 1.1, "orange"), Post(0.1, 0.6, "red", 0.02, 0.1)),
)


def cost_ms(
    width: int, height: int, condition: str, pixel_format: str, turn_rate_rad_s: float, frames: int = 60
) -> float:
    model = load_camera_model(CALIBRATION).scaled(width, height)
    camera = SimulatedCamera(model, conditions(condition), np.random.default_rng(1), pixel_format)
    camera.render(0, OBSERVER, SCENE)
    best = math.inf
    for number in range(frames):
        start = time.process_time()
        camera.render(number, OBSERVER, SCENE, turn_rate_rad_s)
        best = min(best, time.process_time() - start)
    return round(1e3 * best, 3)


def main() -> None:
    cv2.setNumThreads(1)
    figures = {
        "benchmark": "camera",
        "ms_320x240": cost_ms(320, 240, "realistic", "rgb565", 0.0),
        "ms_320x240_yuyv": cost_ms(320, 240, "realistic", "yuyv", 0.0),
        "ms_320x240_hard_turning": cost_ms(320, 240, "hard", "rgb565", 1.2),
        "ms_160x120": cost_ms(160, 120, "realistic", "rgb565", 0.0),
        "ms_640x480": cost_ms(640, 480, "realistic", "rgb565", 0.0),
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
