"""The simulated camera shows what is there, where it is, and the same for the same seed."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from robot_agent.drivers.sim.rendering.camera import SceneCamera, SimulatedCamera
from robot_agent.drivers.sim.rendering.conditions import conditions
from robot_agent.drivers.sim.rendering.scene import Post, Rectangle, Scene, SceneRobot
from robot_agent.vision.camera_model import load_camera_model
from robot_agent.vision.pixels import frame_pixels
from robot_agent.vision.skirt import half_angle_rad
from swarm.errors import UserError
from swarm.geometry import Compartment, Grid, Pose
from tests.support.swarm_runs import ROOT

MODEL = load_camera_model(ROOT / "deploy" / "cameras" / "epuck_320x240.toml")
ROOM = Compartment(0.0, 0.0, Grid(10, 10), 0.12)
OBSERVER = Pose(0.1, 0.6, 0.0)
HORIZON = 120


def camera(name: str = "clean", seed: int = 1, pixel_format: str = "rgb565") -> SimulatedCamera:
    return SimulatedCamera(MODEL, conditions(name), np.random.default_rng(seed), pixel_format)


def view(scene: Scene, turn_rate_rad_s: float = 0.0, name: str = "clean") -> NDArray[np.int64]:
    return frame_pixels(camera(name).render(0, OBSERVER, scene, turn_rate_rad_s)).astype(np.int64)


def body(
    ahead_m: float, left_m: float, skirt: str = "red", velocity: tuple[float, float] = (0, 0)
) -> SceneRobot:
    """A robot seen from the observer's camera."""
    return SceneRobot(
        Pose(OBSERVER.x_m + MODEL.forward_m + ahead_m, OBSERVER.y_m + left_m, 0.0), skirt, velocity
    )


def is_red(pixels: NDArray[np.int64]) -> NDArray[np.bool_]:
    return np.asarray((pixels[..., 0] > 2 * pixels[..., 1]) & (pixels[..., 0] > 2 * pixels[..., 2]))


def test_the_same_seed_gives_the_same_bytes_and_another_does_not() -> None:
    scene = Scene((ROOM,), (body(0.5, 0.1),))
    one, same, other = (camera("hard", seed) for seed in (1, 1, 2))
    frames = [[each.render(number, OBSERVER, scene) for number in range(3)] for each in (one, same, other)]
    assert frames[0] == frames[1]
    assert frames[0] != frames[2]
    assert frames[0][0].data != frames[0][1].data


@pytest.mark.parametrize(("ahead_m", "left_m"), [(0.5, 0.0), (0.8, 0.3), (0.6, -0.25), (1.0, -0.4)])
def test_the_skirt_is_where_the_calibration_says(ahead_m: float, left_m: float) -> None:
    row = is_red(view(Scene((ROOM,), (body(ahead_m, left_m),))))[HORIZON]
    range_m, bearing_rad = math.hypot(ahead_m, left_m), math.atan2(left_m, ahead_m)
    left = MODEL.column(bearing_rad + half_angle_rad(range_m))
    right = MODEL.column(bearing_rad - half_angle_rad(range_m))
    columns = np.flatnonzero(row)
    assert columns[0] == pytest.approx(left + 0.5, abs=2)
    assert columns[-1] == pytest.approx(right - 0.5, abs=2)


def test_a_near_robot_hides_a_far_one_whatever_their_order() -> None:
    near, far = body(0.4, 0.0, "blue"), body(0.9, 0.0, "red")
    for bodies in ((near, far), (far, near)):
        assert not is_red(view(Scene((ROOM,), bodies))).any()


def test_the_observer_does_not_see_itself_and_things_behind_it_are_not_shown() -> None:
    behind = SceneRobot(Pose(OBSERVER.x_m - 0.07, OBSERVER.y_m, 0.0), "red")
    empty = view(Scene((ROOM,)))
    assert np.array_equal(view(Scene((ROOM,), (SceneRobot(OBSERVER, "red"), behind))), empty)


def test_a_robot_at_the_border_is_partly_shown() -> None:
    edge_rad = MODEL.bearing_rad(-0.5)
    pixels = view(Scene((ROOM,), (body(0.5 * math.cos(edge_rad), 0.5 * math.sin(edge_rad)),)))
    columns = np.flatnonzero(is_red(pixels)[HORIZON])
    full = MODEL.column(edge_rad - half_angle_rad(0.5)) + 0.5
    assert columns[0] == 0
    assert columns[-1] == pytest.approx(full, abs=2)


def test_walls_are_white_and_hide_what_is_behind_them() -> None:
    beyond = Rectangle(1.2, 0.0, 2.4, 1.2)
    pixels = view(Scene((ROOM, beyond), (SceneRobot(Pose(1.5, 0.6, 0.0), "red"),)))
    wall = pixels[HORIZON - 3, 100:220]
    assert not is_red(pixels)[HORIZON].any()
    assert wall.min() > 150
    assert np.ptp(wall, axis=-1).max() < 20


def test_who_stands_outside_a_corner_looks_in() -> None:
    outside = Pose(1.25, -0.05, math.radians(135))
    scene = Scene((ROOM,), (SceneRobot(Pose(0.8, 0.4, 0.0), "red"),))
    assert is_red(frame_pixels(camera().render(0, outside, scene)).astype(np.int64))[HORIZON].any()


def test_distractors_of_the_hard_conditions_stay_where_they_are() -> None:
    hard = camera("hard", 3)
    first, second = (frame_pixels(hard.render(n, OBSERVER, Scene((ROOM,)))).astype(np.int64) for n in (0, 1))
    plain = frame_pixels(camera("realistic", 3).render(0, OBSERVER, Scene((ROOM,)))).astype(np.int64)
    saturation = [np.ptp(pixels[HORIZON - 8 : HORIZON], axis=-1) > 70 for pixels in (first, second, plain)]
    assert saturation[0].sum() > 20
    assert (saturation[0] != saturation[1]).mean() < 0.01
    assert saturation[2].sum() == 0


def test_speed_and_turning_blur_the_sides() -> None:
    def soft_columns(scene: Scene, turn_rate_rad_s: float) -> int:
        green = view(scene, turn_rate_rad_s, "realistic")[HORIZON - 2 : HORIZON + 2, :, 1].mean(axis=0)
        near = green[130:190]
        return int(((near > near.min() + 25) & (near < near.max() - 25)).sum())

    at_rest = soft_columns(Scene((ROOM,), (body(0.5, 0.0),)), 0.0)
    assert soft_columns(Scene((ROOM,), (body(0.5, 0.0, velocity=(0.0, 0.3)),)), 0.0) > at_rest
    assert soft_columns(Scene((ROOM,), (body(0.5, 0.0),)), 1.0) > at_rest


def test_with_the_lights_off_nothing_is_to_be_seen() -> None:
    assert frame_pixels(camera("dark").render(0, OBSERVER, Scene((ROOM,), (body(0.4, 0.0),)))).max() < 70


def test_both_formats_show_the_same() -> None:
    scene = Scene((ROOM,), (body(0.4, 0.0),))
    one, other = (camera("clean", 1, pixel_format) for pixel_format in ("rgb565", "yuyv"))
    rgb565, yuyv = (frame_pixels(each.render(0, OBSERVER, scene)).astype(int) for each in (one, other))
    assert np.percentile(np.abs(rgb565 - yuyv), 95) < 8


def test_a_stalled_camera_gives_no_frame() -> None:
    scene = Scene((ROOM,), (body(0.4, 0.0),))
    eye = SceneCamera(camera(), lambda t_ns: (OBSERVER, scene, 0.0) if t_ns < 5 else None)
    frame = eye.capture(4)
    assert frame is not None
    assert frame.t_ns == 4
    assert eye.capture(5) is None


def test_a_colour_that_is_not_known_is_named() -> None:
    with pytest.raises(UserError, match="'rde'; did you mean 'red'"):
        camera().render(0, OBSERVER, Scene((ROOM,), (body(0.4, 0.0, "rde"),)))
    with pytest.raises(UserError, match="unknown colour 'puce'"):
        camera().render(0, OBSERVER, Scene((ROOM,), (), (Post(0.5, 0.5, "puce"),)))


def test_conditions_and_formats_that_are_not_known_are_named() -> None:
    with pytest.raises(UserError, match="did you mean 'realistic'"):
        conditions("realstic")
    with pytest.raises(UserError, match="'jpeg'"):
        camera(pixel_format="jpeg")


def test_importing_the_driver_does_not_load_numba() -> None:
    program = (
        "import sys, robot_agent.drivers.sim.rendering.camera, robot_agent.vision.detector;"
        "print('numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
