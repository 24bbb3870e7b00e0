"""The demonstrator is found, exactly and surely, or the reason is said; on rendered frames."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera
from robot_agent.drivers.sim.rendering.scene import Body, Post, Rectangle, Scene
from robot_agent.vision.camera_model import load_camera_model
from robot_agent.vision.colour_table import ColourTable
from robot_agent.vision.detector import NotSeen, Reason, Seer, Sighting
from robot_agent.vision.frames import Frame
from robot_agent.vision.skirt import half_angle_rad
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.benchmarks.seeing import CALIBRATION, accuracy, driving, is_wrong, make_pair, scattered

MODEL = load_camera_model(CALIBRATION)
ROOM = Rectangle(0.0, 0.0, 1.2, 1.2)
OBSERVER = Pose(0.05, 0.6, 0.0)
STEP_NS = 200_000_000


@pytest.fixture(scope="module")
def pair() -> tuple[SimulatedCamera, Seer]:
    return make_pair("best", "realistic", "red", 11)


@pytest.fixture
def camera(pair: tuple[SimulatedCamera, Seer]) -> SimulatedCamera:
    return pair[0]


@pytest.fixture
def seer(pair: tuple[SimulatedCamera, Seer]) -> Seer:
    pair[1].reset()
    return pair[1]


def body(range_m: float, bearing_deg: float, skirt: str = "red") -> Body:
    """A robot seen from the observer's camera."""
    bearing_rad = math.radians(bearing_deg)
    x_m = OBSERVER.x_m + MODEL.forward_m + range_m * math.cos(bearing_rad)
    return Body(Pose(x_m, OBSERVER.y_m + range_m * math.sin(bearing_rad), 0.0), skirt)


def post(range_m: float, bearing_deg: float, colour: str, radius_m: float, height_m: float) -> Post:
    place = body(range_m, bearing_deg).pose
    return Post(place.x_m, place.y_m, colour, radius_m, height_m)


def frame(camera: SimulatedCamera, *things: Body | Post, t_ns: int = 0, own: Pose = OBSERVER) -> Frame:
    bodies = tuple(thing for thing in things if isinstance(thing, Body))
    posts = tuple(thing for thing in things if isinstance(thing, Post))
    return camera.render(t_ns, own, Scene((ROOM,), bodies, posts))


def reason(answer: Sighting | NotSeen) -> Reason:
    assert isinstance(answer, NotSeen), answer
    return answer.reason


def sighting(answer: Sighting | NotSeen) -> Sighting:
    assert isinstance(answer, Sighting), answer
    return answer


@pytest.mark.parametrize(("skirt", "pixel_format"), [("red", "rgb565"), ("blue", "yuyv")])
def test_range_and_bearing_are_within_the_bounds(skirt: str, pixel_format: str) -> None:
    figures = accuracy(list(scattered("best", "realistic", skirt, 200, 3, pixel_format)), MODEL)
    assert figures["answered_by_both_edges"] >= 0.99
    assert figures["width_sd_px"] <= 0.2
    assert figures["range_k_per_cm"] <= 1e-4
    assert figures["range_bias_of_bound"] <= 1
    assert figures["bearing_sd_deg"] <= 0.15
    assert abs(figures["bearing_bias_deg"]) <= 0.05


def test_posts_of_the_skirts_colour_are_seldom_taken_for_it() -> None:
    looks = list(driving("best", "realistic", "red", 300, 5, twins=2))
    assert sum(is_wrong(look) for look in looks) <= 0.005 * len(looks)
    assert sum(isinstance(look.said, Sighting) for look in looks) >= 0.8 * len(looks)


def test_the_papers_profile_counts_pixels_and_says_how_unsure_it_is() -> None:
    looks = list(scattered("paper", "realistic", "red", 150, 3))
    figures = accuracy(looks, MODEL.scaled(160, 120))
    assert figures["answered"] >= 0.93
    assert 3e-4 <= figures["range_k_per_cm"] <= 9e-4
    assert 0.6 <= figures["range_error_of_sd"] <= 1.4


def test_the_covariance_grows_as_the_square_of_the_range(camera: SimulatedCamera, seer: Seer) -> None:
    near = sighting(seer.look(frame(camera, body(0.4, 5))))
    seer.reset()
    far = sighting(seer.look(frame(camera, body(1.0, 5))))
    assert far.range_sd_m / near.range_sd_m == pytest.approx((far.range_m / near.range_m) ** 2)
    assert far.bearing_rad == pytest.approx(math.radians(5), abs=0.003)


@pytest.mark.parametrize("range_m", [0.13, 0.2, 0.35])
def test_a_near_robot_fills_the_image_and_is_measured(
    camera: SimulatedCamera, seer: Seer, range_m: float
) -> None:
    answer = sighting(seer.look(frame(camera, body(range_m, -6.0))))
    assert answer.range_m == pytest.approx(range_m, rel=0.01)
    assert answer.bearing_rad == pytest.approx(math.radians(-6.0), abs=0.003)


@pytest.mark.parametrize("tilt_px", [-5.5, 5.5])
def test_a_tilted_robot_sees_as_well(camera: SimulatedCamera, seer: Seer, tilt_px: float) -> None:
    """One degree of tilt moves the horizon by 5.5 rows from where the calibration puts it."""
    tilted = SimulatedCamera(
        replace(MODEL, horizon=0.5 + tilt_px / 240), camera.conditions, np.random.default_rng(11)
    )
    for range_m in (0.3, 0.7, 1.1):
        seer.reset()
        answer = sighting(seer.look(frame(tilted, body(range_m, 8.0))))
        assert answer.range_m == pytest.approx(range_m, rel=0.02)


def test_an_empty_compartment(camera: SimulatedCamera, seer: Seer) -> None:
    assert reason(seer.look(frame(camera))) is Reason.NOT_SEEN


def test_a_robot_with_another_skirt_is_not_the_demonstrator(camera: SimulatedCamera, seer: Seer) -> None:
    assert reason(seer.look(frame(camera, body(0.6, 0, "blue"), body(0.8, 12, "orange")))) is Reason.NOT_SEEN


def test_a_post_of_the_colour_has_not_the_shape(camera: SimulatedCamera, seer: Seer) -> None:
    tall, wide = post(0.6, -5, "red", 0.015, 0.1), post(0.7, 8, "red", 0.036, 0.05)
    assert reason(seer.look(frame(camera, tall, wide))) is Reason.UNLIKE


def test_two_robots_with_the_same_skirt(camera: SimulatedCamera, seer: Seer) -> None:
    answer = seer.look(frame(camera, body(0.6, -10), body(0.8, 10)))
    assert reason(answer) is Reason.TWO_CANDIDATES


def test_the_gate_keeps_to_the_robot_that_was_seen_first(camera: SimulatedCamera, seer: Seer) -> None:
    seer.look(frame(camera, body(0.6, -10)))
    both = frame(camera, body(0.61, -9), body(0.9, 10), t_ns=STEP_NS)
    assert sighting(seer.look(both, turned_rad=0.0)).bearing_rad == pytest.approx(math.radians(-9), abs=0.01)
    other = frame(camera, body(0.9, 10), t_ns=2 * STEP_NS)
    assert reason(seer.look(other, turned_rad=0.0)) is Reason.JUMPED
    seer.reset()
    assert sighting(seer.look(other)).range_m == pytest.approx(0.9, abs=0.02)


def test_the_gate_follows_the_observers_own_turn(camera: SimulatedCamera, seer: Seer) -> None:
    """Told of the turn, the seer expects the demonstrator elsewhere in the image."""
    turned = Pose(OBSERVER.x_m, OBSERVER.y_m, 0.25)
    for told_rad, seen in ((0.25, True), (0.0, False), (None, True)):
        seer.reset()
        seer.look(frame(camera, body(0.6, 0)))
        answer = seer.look(frame(camera, body(0.6, 0), t_ns=STEP_NS, own=turned), turned_rad=told_rad)
        assert isinstance(answer, Sighting) is seen


def test_lights_off(seer: Seer) -> None:
    dark, _ = make_pair("best", "realistic", "red", 12)
    black = Frame(0, 320, 240, "rgb565", bytes(320 * 240 * 2))
    assert reason(seer.look(black)) is Reason.DARK
    assert sighting(seer.look(frame(dark, body(0.5, 0)))).range_m == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("side", [1, -1])
def test_half_of_the_robot_outside_the_image_is_a_coarse_sighting(
    camera: SimulatedCamera, seer: Seer, side: int
) -> None:
    bearing_deg = 25.2 * side
    answer = sighting(seer.look(frame(camera, body(0.5, bearing_deg))))
    assert answer.cut_off
    assert (answer.left_px is None) == (side == 1)
    assert answer.range_m == pytest.approx(0.5, abs=3 * answer.range_sd_m)
    assert answer.range_sd_m > 0.01
    assert answer.bearing_rad == pytest.approx(math.radians(bearing_deg), abs=3 * answer.bearing_sd_rad)


@pytest.mark.parametrize("side", [1, -1])
def test_counted_pixels_say_nothing_of_a_robot_that_is_cut_off(side: int) -> None:
    camera, seer = make_pair("paper", "realistic", "red", 11)
    answer = sighting(seer.look(frame(camera, body(0.4, 25.0 * side))))
    assert answer.cut_off
    visible_rad = math.radians(25.0 * side) - side * half_angle_rad(0.4)
    visible_px = answer.right_px if side == 1 else answer.left_px
    assert visible_px == pytest.approx(seer.model.column(visible_rad), abs=1.0)


def test_a_sliver_of_the_robot_is_not_enough(camera: SimulatedCamera, seer: Seer) -> None:
    assert reason(seer.look(frame(camera, body(0.5, 29.0)))) is Reason.CUT_OFF


def test_a_robot_too_close_to_measure(camera: SimulatedCamera, seer: Seer) -> None:
    assert reason(seer.look(frame(camera, body(0.07, 0.0)))) in (Reason.CUT_OFF, Reason.UNLIKE)


def test_an_edge_behind_something_is_not_measured(camera: SimulatedCamera, seer: Seer) -> None:
    """The range then comes from the height, and the covariance says how coarse that is."""
    hidden = frame(camera, body(0.8, 0), post(0.5, 3.0, "blue", 0.012, 0.08))
    answer = sighting(seer.look(hidden))
    assert answer.right_px is not None
    assert answer.left_px is None
    assert answer.range_m == pytest.approx(0.8, abs=3 * answer.range_sd_m)


def test_a_robot_behind_a_post_between_both_edges_is_hidden(camera: SimulatedCamera, seer: Seer) -> None:
    posts = (post(0.5, 3.0, "blue", 0.012, 0.08), post(0.5, -3.0, "blue", 0.012, 0.08))
    assert reason(seer.look(frame(camera, body(0.8, 0), *posts))) is Reason.HIDDEN


def test_a_frame_of_another_size_is_refused(seer: Seer) -> None:
    with pytest.raises(UserError, match="gives 160 x 120 frames, the profile needs 320 x 240"):
        seer.look(Frame(0, 160, 120, "rgb565", bytes(160 * 120 * 2)))


def test_a_profile_that_is_not_known_is_named() -> None:
    table = ColourTable("red", np.zeros(1 << 16, dtype=np.uint8), 1)
    with pytest.raises(UserError, match="did you mean 'paper'"):
        Seer("papers", MODEL, table)


def test_any_bytes_give_an_answer(seer: Seer) -> None:
    """A broken sensor sends noise: no frame may stop the robot."""
    rng = np.random.default_rng(1)
    for number in range(20):
        noise = rng.integers(0, 256, 320 * 240 * 2, dtype=np.uint8)
        if number % 2:
            noise[:] = np.repeat(rng.integers(0, 256, 1200, dtype=np.uint8), 128)
        assert isinstance(seer.look(Frame(number, 320, 240, "rgb565", noise.tobytes())), (Sighting, NotSeen))


def test_a_board_needs_no_numba() -> None:
    program = (
        "import sys; sys.modules['numba'] = None\n"
        "import numpy as np\n"
        "from robot_agent.vision.detector import Seer\n"
        "from robot_agent.vision.colour_table import ColourTable\n"
        "from robot_agent.vision.frames import Frame\n"
        "from robot_agent.vision.camera_model import CameraModel\n"
        "seer = Seer('best', CameraModel(320, 240, 0.9), ColourTable('red', np.ones(65536, np.uint8), 1))\n"
        "print(seer.look(Frame(0, 320, 240, 'rgb565', b'\\xff' * 153600)).reason.name)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "UNLIKE"
