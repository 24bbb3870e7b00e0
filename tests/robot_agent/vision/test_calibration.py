"""Demonstrators are learnt from frames, wherever they stand, or the reason is said."""

from __future__ import annotations

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera, calibration_frames
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.vision.calibration import learn_demonstrator
from robot_agent.vision.camera_model import load_camera_model
from robot_agent.vision.demonstrator import Skirt
from robot_agent.vision.frames import Frame
from swarm.errors import UserError
from tests.benchmarks.seeing import CALIBRATION, random_scene

MODEL = load_camera_model(CALIBRATION)


@pytest.fixture(scope="module")
def camera() -> SimulatedCamera:
    return SimulatedCamera(MODEL, conditions("realistic"), np.random.default_rng(5))


@pytest.mark.parametrize(
    ("skirt", "channels"),
    [("red", {1}), ("blue", {1}), ("green", {0, 2}), ("yellow", {2}), ("magenta", {1})],
)
def test_a_skirt_of_any_colour_is_learnt(camera: SimulatedCamera, skirt: str, channels: set[int]) -> None:
    learnt = learn_demonstrator(calibration_frames(camera, skirt, (0.25, 0.35)), MODEL, Skirt(skirt))
    assert (learnt.seen, learnt.frames) == (2, 2)
    assert learnt.demonstrator.skirt.edge_channel in channels
    assert learnt.demonstrator.hat is not None
    assert learnt.demonstrator.hat.stands_out
    assert abs(learnt.pitch_deg) < 0.6
    assert 0 < learnt.range_sd_part < 0.01


def test_the_robot_may_stand_anywhere_in_view(camera: SimulatedCamera) -> None:
    """With another robot and a post of other colours in the room."""
    rng = np.random.default_rng(7)
    frames = [camera.render(0, *random_scene(MODEL, "red", rng)) for _ in range(8)]
    learnt = learn_demonstrator(frames, MODEL, Skirt("red"))
    red, green, blue = learnt.demonstrator.skirt.colour
    assert red > 5 * max(green, blue)
    assert learnt.seen >= 7


def test_learning_says_what_is_wrong_with_the_frames(camera: SimulatedCamera) -> None:
    with pytest.raises(UserError, match="no frame"):
        learn_demonstrator([], MODEL, Skirt())
    with pytest.raises(UserError, match="calibration for 160 x 120"):
        learn_demonstrator(calibration_frames(camera, "red", (0.3,)), MODEL.scaled(160, 120), Skirt())
    with pytest.raises(UserError, match="nothing of a skirt's shape and of one colour is in 1 of 1 frames"):
        learn_demonstrator(calibration_frames(camera, "white", (0.3,)), MODEL, Skirt())
    noise = np.random.default_rng(1).integers(0, 256, 320 * 240 * 2, dtype=np.uint8)
    with pytest.raises(UserError, match="20 to 100 cm before the camera"):
        learn_demonstrator([Frame(0, 320, 240, "rgb565", noise.tobytes())], MODEL, Skirt())
