"""Hats, lamps, exposure, tilt, blur, noise and image sizes, rendered: each seen after one calibration."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import Conditions, SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Scene
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import CameraModel, load_camera_model
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.detector import Detection, Detector
from swarm.config.experiment import CopyProfile
from swarm.geometry import Pose
from tests.benchmarks.seeing import CALIBRATION, Look, is_wrong, look_at, random_scene

PLAIN = conditions("realistic")
FRAMES = 30


@dataclass(frozen=True)
class Laboratory:
    """What is otherwise than at calibration; the hat is the calibrated one."""

    light: Conditions = PLAIN
    hat: str = ""
    pitch_deg: float = 0.0
    width: int = 320

    @property
    def file(self) -> CameraModel:
        return load_camera_model(CALIBRATION).scaled(self.width, self.width * 3 // 4)

    @property
    def camera(self) -> SimulatedCamera:
        """It looks up by the pitch, which moves the horizon down, and the file does not say so."""
        down = math.tan(math.radians(self.pitch_deg)) * self.file.focal_px / self.file.height
        return SimulatedCamera(replace(self.file, horizon=0.5 + down), self.light, np.random.default_rng(6))

    def view(self, rng: np.random.Generator) -> tuple[Pose, Scene]:
        own, scene = random_scene(self.file, "red", rng)
        return own, replace(scene, bodies=(replace(scene.bodies[0], hat=self.hat), *scene.bodies[1:]))


DIM_AND_WARM = replace(PLAIN, white_level=0.19, cast=(1.35, 1.0, 0.65))
BRIGHT_AND_WARM = replace(PLAIN, white_level=0.93, cast=(1.3, 1.0, 0.7))
NOISY = replace(PLAIN, full_well_electrons=450.0, read_noise=0.018)
BLURRED = replace(PLAIN, lens_blur_rad=0.0062)

LABORATORIES = {
    "yellow hat": Laboratory(hat="yellow"),
    "white hat": Laboratory(hat="white"),
    "dim and warm": Laboratory(DIM_AND_WARM, "white"),
    "bright, warm and looking down": Laboratory(BRIGHT_AND_WARM, "yellow", -3.0),
    "looking up": Laboratory(pitch_deg=3.0),
    "noise": Laboratory(NOISY),
    "blur": Laboratory(BLURRED, "yellow"),
    "small images": Laboratory(hat="yellow", width=160),
    "large images": Laboratory(hat="yellow", width=640),
}


@pytest.mark.parametrize("name", LABORATORIES)
def test_the_demonstrator_is_seen_after_one_calibration(name: str) -> None:
    laboratory, rng = LABORATORIES[name], np.random.default_rng(77)
    neutral = SimulatedCamera(laboratory.file, PLAIN, np.random.default_rng(5))
    frames = [neutral.render(0, *laboratory.view(rng)) for _ in range(12)]
    learnt = learn_demonstrator(frames, laboratory.file, Skirt("red")).demonstrator
    detector, camera = Detector(CopyProfile.BEST, laboratory.file, learnt), laboratory.camera
    looks = [looked(detector, camera, *laboratory.view(rng)) for _ in range(FRAMES)]
    assert sum(isinstance(look.said, Detection) for look in looks) >= 0.97 * FRAMES
    assert not any(is_wrong(look) for look in looks)
    assert math.degrees(detector.tilt.pitch_rad) == pytest.approx(laboratory.pitch_deg, abs=0.5)


def looked(detector: Detector, camera: SimulatedCamera, own: Pose, scene: Scene) -> Look:
    """A frame by itself."""
    detector.reset()
    return look_at(camera, detector, own, scene, 0, 0.0)


def test_the_light_may_change_during_a_run() -> None:
    """From a neutral to a warm and dim lamp, in steps as between two frames."""
    laboratory, rng = Laboratory(hat="white"), np.random.default_rng(3)
    own, scene = laboratory.view(rng)
    neutral = laboratory.camera
    learnt = learn_demonstrator([neutral.render(0, own, scene)], laboratory.file, Skirt("red")).demonstrator
    detector = Detector(CopyProfile.BEST, laboratory.file, learnt)
    for number, part in enumerate(np.linspace(0, 1, 15)):
        cast = (1 + 0.35 * part, 1.0, 1 - 0.35 * part)
        light = replace(PLAIN, white_level=PLAIN.white_level * (1 - 0.6 * part), cast=cast)
        camera = SimulatedCamera(laboratory.file, light, np.random.default_rng(6))
        answer = detector.look(camera.render(number * 200_000_000, own, scene), turned_rad=0.0)
        assert isinstance(answer, Detection), (number, answer)
