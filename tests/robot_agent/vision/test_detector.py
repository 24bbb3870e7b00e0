"""The demonstrator is found, exactly and surely, or the reason is said; on rendered frames."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from robot_agent.drivers.sim.rendering.camera import SimulatedCamera
from robot_agent.drivers.sim.rendering.scene import Post, Rectangle, Scene, SceneRobot
from robot_agent.vision.camera_model import load_camera_model
from robot_agent.vision.detector import SCALE_SD_PART, Detection, Detector, NotSeen, Reason
from robot_agent.vision.frames import Frame
from robot_agent.vision.skirt import half_angle_rad
from swarm.config.experiment import CopyProfile
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.benchmarks.seeing import CALIBRATION, accuracy, driving, is_wrong, make_pair, scattered

MODEL = load_camera_model(CALIBRATION)
ROOM = Rectangle(0.0, 0.0, 1.2, 1.2)
OBSERVER = Pose(0.05, 0.6, 0.0)
STEP_NS = 200_000_000


@pytest.fixture(scope="module")
def pair() -> tuple[SimulatedCamera, Detector]:
    return make_pair(CopyProfile.BEST, "realistic", "red", 11)


@pytest.fixture
def camera(pair: tuple[SimulatedCamera, Detector]) -> SimulatedCamera:
    return pair[0]


@pytest.fixture
def detector(pair: tuple[SimulatedCamera, Detector]) -> Detector:
    pair[1].reset()
    return pair[1]


def body(range_m: float, bearing_deg: float, skirt: str = "red") -> SceneRobot:
    """A robot seen from the observer's camera."""
    bearing_rad = math.radians(bearing_deg)
    x_m = OBSERVER.x_m + MODEL.forward_m + range_m * math.cos(bearing_rad)
    return SceneRobot(Pose(x_m, OBSERVER.y_m + range_m * math.sin(bearing_rad), 0.0), skirt)


def post(range_m: float, bearing_deg: float, colour: str, radius_m: float, height_m: float) -> Post:
    place = body(range_m, bearing_deg).pose
    return Post(place.x_m, place.y_m, colour, radius_m, height_m)


def frame(camera: SimulatedCamera, *things: SceneRobot | Post, t_ns: int = 0, own: Pose = OBSERVER) -> Frame:
    bodies = tuple(thing for thing in things if isinstance(thing, SceneRobot))
    posts = tuple(thing for thing in things if isinstance(thing, Post))
    return camera.render(t_ns, own, Scene((ROOM,), bodies, posts))


def reason(answer: Detection | NotSeen) -> Reason:
    assert isinstance(answer, NotSeen), answer
    return answer.reason


def detection(answer: Detection | NotSeen) -> Detection:
    assert isinstance(answer, Detection), answer
    return answer


@pytest.mark.parametrize(("skirt", "pixel_format"), [("red", "rgb565"), ("blue", "yuyv")])
def test_range_and_bearing_are_within_the_bounds(skirt: str, pixel_format: str) -> None:
    figures = accuracy(list(scattered(CopyProfile.BEST, "realistic", skirt, 200, 3, pixel_format)), MODEL)
    assert figures["answered_by_both_edges"] >= 0.99
    assert figures["width_sd_px"] <= 0.2
    assert figures["range_k_per_cm"] <= 1e-4
    assert figures["range_bias_of_bound"] <= 1
    assert figures["bearing_sd_deg"] <= 0.15
    assert abs(figures["bearing_bias_deg"]) <= 0.05


def test_posts_of_the_skirts_colour_are_seldom_taken_for_it() -> None:
    looks = list(driving(CopyProfile.BEST, "realistic", "red", 300, 5, twins=2))
    assert sum(is_wrong(look) for look in looks) <= 0.005 * len(looks)
    assert sum(isinstance(look.said, Detection) for look in looks) >= 0.8 * len(looks)


def test_the_papers_profile_counts_pixels_and_says_how_unsure_it_is() -> None:
    looks = list(scattered(CopyProfile.PAPER, "realistic", "red", 150, 3))
    figures = accuracy(looks, MODEL.scaled(160, 120))
    assert figures["answered"] >= 0.93
    assert 3e-4 <= figures["range_k_per_cm"] <= 9e-4
    assert 0.6 <= figures["range_error_of_sd"] <= 1.4


def test_the_covariance_grows_with_the_range(camera: SimulatedCamera, detector: Detector) -> None:
    """The edges' part as its square, and more: fewer rows far away average less."""
    near = detection(detector.look(frame(camera, body(0.4, 5))))
    detector.reset()
    far = detection(detector.look(frame(camera, body(1.0, 5))))
    ratio = far.range_m / near.range_m
    edges_sd_m = [math.sqrt(one.covariance[0][0] - (SCALE_SD_PART * one.range_m) ** 2) for one in (near, far)]
    assert ratio**2 <= edges_sd_m[1] / edges_sd_m[0] <= 3 * ratio**2
    assert far.bearing_rad == pytest.approx(math.radians(5), abs=0.003)


@pytest.mark.parametrize("range_m", [0.13, 0.2, 0.35])
def test_a_near_robot_fills_the_image_and_is_measured(
    camera: SimulatedCamera, detector: Detector, range_m: float
) -> None:
    answer = detection(detector.look(frame(camera, body(range_m, -6.0))))
    assert answer.range_m == pytest.approx(range_m, rel=0.01)
    assert answer.bearing_rad == pytest.approx(math.radians(-6.0), abs=0.003)


@pytest.mark.parametrize("tilt_px", [-5.5, 5.5])
def test_a_tilted_robot_sees_as_well(camera: SimulatedCamera, detector: Detector, tilt_px: float) -> None:
    """One degree of tilt moves the horizon by 5.5 rows from where the calibration puts it."""
    tilted = SimulatedCamera(
        replace(MODEL, horizon=0.5 + tilt_px / 240), camera.conditions, np.random.default_rng(11)
    )
    for range_m in (0.3, 0.7, 1.1):
        detector.reset()
        answer = detection(detector.look(frame(tilted, body(range_m, 8.0))))
        assert answer.range_m == pytest.approx(range_m, rel=0.02)


def test_an_empty_compartment(camera: SimulatedCamera, detector: Detector) -> None:
    assert reason(detector.look(frame(camera))) is Reason.NOT_SEEN


def test_a_robot_with_another_skirt_is_not_the_demonstrator(
    camera: SimulatedCamera, detector: Detector
) -> None:
    assert (
        reason(detector.look(frame(camera, body(0.6, 0, "blue"), body(0.8, 12, "orange")))) is Reason.NOT_SEEN
    )


def test_a_post_of_the_colour_has_not_the_shape(camera: SimulatedCamera, detector: Detector) -> None:
    tall, wide = post(0.6, -5, "red", 0.015, 0.1), post(0.7, 8, "red", 0.036, 0.05)
    assert reason(detector.look(frame(camera, tall, wide))) is Reason.UNLIKE


def test_two_robots_with_the_same_skirt(camera: SimulatedCamera, detector: Detector) -> None:
    answer = detector.look(frame(camera, body(0.6, -10), body(0.8, 10)))
    assert reason(answer) is Reason.TWO_CANDIDATES


def test_the_gate_keeps_to_the_robot_that_was_seen_first(camera: SimulatedCamera, detector: Detector) -> None:
    detector.look(frame(camera, body(0.6, -10)))
    both = frame(camera, body(0.61, -9), body(0.9, 10), t_ns=STEP_NS)
    assert detection(detector.look(both, turned_rad=0.0)).bearing_rad == pytest.approx(
        math.radians(-9), abs=0.01
    )
    other = frame(camera, body(0.9, 10), t_ns=2 * STEP_NS)
    assert reason(detector.look(other, turned_rad=0.0)) is Reason.JUMPED
    detector.reset()
    assert detection(detector.look(other)).range_m == pytest.approx(0.9, abs=0.02)


def test_the_gate_follows_the_observers_own_turn(camera: SimulatedCamera, detector: Detector) -> None:
    """Told of the turn, the detector expects the demonstrator elsewhere in the image."""
    turned = Pose(OBSERVER.x_m, OBSERVER.y_m, 0.25)
    for told_rad, seen in ((0.25, True), (0.0, False), (None, True)):
        detector.reset()
        detector.look(frame(camera, body(0.6, 0)))
        answer = detector.look(frame(camera, body(0.6, 0), t_ns=STEP_NS, own=turned), turned_rad=told_rad)
        assert isinstance(answer, Detection) is seen


def test_lights_off(detector: Detector) -> None:
    dark, _ = make_pair(CopyProfile.BEST, "realistic", "red", 12)
    black = Frame(0, 320, 240, "rgb565", bytes(320 * 240 * 2))
    assert reason(detector.look(black)) is Reason.DARK
    assert detection(detector.look(frame(dark, body(0.5, 0)))).range_m == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("side", [1, -1])
def test_half_of_the_robot_outside_the_image_is_a_coarse_sighting(
    camera: SimulatedCamera, detector: Detector, side: int
) -> None:
    bearing_deg = 25.2 * side
    answer = detection(detector.look(frame(camera, body(0.5, bearing_deg))))
    assert answer.cut_off
    assert (answer.left_px is None) == (side == 1)
    assert answer.range_m == pytest.approx(0.5, abs=3 * answer.range_sd_m)
    assert answer.range_sd_m > 0.01
    assert answer.bearing_rad == pytest.approx(math.radians(bearing_deg), abs=3 * answer.bearing_sd_rad)


@pytest.mark.parametrize("side", [1, -1])
def test_counted_pixels_say_nothing_of_a_robot_that_is_cut_off(side: int) -> None:
    camera, detector = make_pair(CopyProfile.PAPER, "realistic", "red", 11)
    answer = detection(detector.look(frame(camera, body(0.4, 25.0 * side))))
    assert answer.cut_off
    visible_rad = math.radians(25.0 * side) - side * half_angle_rad(0.4)
    visible_px = answer.right_px if side == 1 else answer.left_px
    assert visible_px == pytest.approx(detector.model.column(visible_rad), abs=1.0)


def test_a_sliver_of_the_robot_is_not_enough(camera: SimulatedCamera, detector: Detector) -> None:
    assert reason(detector.look(frame(camera, body(0.5, 29.0)))) is Reason.CUT_OFF


def test_a_robot_too_close_to_measure(camera: SimulatedCamera, detector: Detector) -> None:
    assert reason(detector.look(frame(camera, body(0.07, 0.0)))) in (Reason.CUT_OFF, Reason.UNLIKE)


def test_an_edge_behind_something_is_not_measured(camera: SimulatedCamera, detector: Detector) -> None:
    """The range then comes from the height, and the covariance says how coarse that is."""
    hidden = frame(camera, body(0.8, 0), post(0.5, 3.0, "blue", 0.012, 0.08))
    answer = detection(detector.look(hidden))
    assert answer.right_px is not None
    assert answer.left_px is None
    assert answer.range_m == pytest.approx(0.8, abs=3 * answer.range_sd_m)


def test_a_robot_behind_a_post_between_both_edges_is_hidden(
    camera: SimulatedCamera, detector: Detector
) -> None:
    posts = (post(0.5, 3.0, "blue", 0.012, 0.08), post(0.5, -3.0, "blue", 0.012, 0.08))
    assert reason(detector.look(frame(camera, body(0.8, 0), *posts))) is Reason.HIDDEN


def test_a_frame_of_another_size_is_refused(detector: Detector) -> None:
    with pytest.raises(UserError, match="gives 160 x 120 frames, the profile needs 320 x 240"):
        detector.look(Frame(0, 160, 120, "rgb565", bytes(160 * 120 * 2)))


def test_any_bytes_give_an_answer(detector: Detector) -> None:
    """A broken sensor sends noise: no frame may stop the robot."""
    rng = np.random.default_rng(1)
    for number in range(20):
        noise = rng.integers(0, 256, 320 * 240 * 2, dtype=np.uint8)
        if number % 2:
            noise[:] = np.repeat(rng.integers(0, 256, 1200, dtype=np.uint8), 128)
        assert isinstance(
            detector.look(Frame(number, 320, 240, "rgb565", noise.tobytes())), (Detection, NotSeen)
        )


def test_a_board_needs_no_numba() -> None:
    program = (
        "import sys; sys.modules['numba'] = None\n"
        "from robot_agent.vision.detector import Detector\n"
        "from robot_agent.vision.demonstrator import Demonstrator\n"
        "from robot_agent.vision.frames import Frame\n"
        "from robot_agent.vision.camera_model import CameraModel\n"
        "detector = Detector('best', CameraModel(320, 240, 0.9), Demonstrator())\n"
        "print(detector.look(Frame(0, 320, 240, 'rgb565', b'\\xff' * 153600)).reason.name)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "NOT_SEEN"
