"""A camera's lens and place, found from pictures, against the camera that was rendered."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from swarm.errors import UserError
from tests.support.overhead_scene import Conditions, OverheadScene
from tracker_bridge.emulators.camera.calibration import SQUARE_M, board_pictures
from tracker_bridge.overhead.arena_view import (
    ArenaView,
    corners_of_known_tags,
    fitted_squares,
    undistorted_lens,
    view_from_known_points,
)
from tracker_bridge.overhead.lens import Board, find_lens
from tracker_bridge.overhead.tags import TagFamily

Floats = npt.NDArray[np.float64]


@pytest.fixture(name="scene", scope="module")
def _scene() -> OverheadScene:
    return OverheadScene(Conditions(is_littered=False), TagFamily("36h11"), 3)


def test_lens_and_place_are_found_to_a_millimetre(scene: OverheadScene) -> None:
    found, true = scene.calibrated_view(boards=8), scene.true_view()
    assert found.lens.focal_u_px == pytest.approx(true.lens.focal_u_px, rel=0.01)
    assert found.residual_px < 0.5
    east, north = np.meshgrid(np.linspace(0.1, 2.9, 8), np.linspace(0.1, 2.9, 8))
    places_m = np.column_stack([east.ravel(), north.ravel(), np.full(east.size, 0.12)])
    seen_m = found.at_height(true.pixels(places_m), 0.12)
    assert np.linalg.norm(seen_m - places_m[:, :2], axis=1).max() < 0.002


def test_the_height_of_a_tag_is_corrected_for(scene: OverheadScene) -> None:
    view, place_m = scene.true_view(), np.array([[2.8, 0.2, 0.12]])
    pixels = view.pixels(place_m)
    assert view.at_height(pixels, 0.12) == pytest.approx(place_m[:, :2], abs=1e-6)
    beyond_m = np.linalg.norm(view.at_height(pixels, 0.0) - place_m[:, :2])
    assert beyond_m == pytest.approx(0.12 / 2.38 * math.hypot(1.3, 1.3), rel=0.01), "taken for flat"


def test_a_board_that_is_not_seen_is_said(scene: OverheadScene) -> None:
    pictures = list(board_pictures(scene.camera, 2, np.random.default_rng(1)))
    with pytest.raises(UserError, match=r"seen in 0 of 2 pictures and 5 are needed"):
        find_lens(pictures, Board(7, 5, SQUARE_M))


def known_points(view: ArenaView) -> tuple[Floats, Floats]:
    poses = {0: (0.3, 0.3, 0.0, 0.0), 1: (2.7, 0.4, 0.0, 1.0), 2: (1.4, 2.6, 0.0, 2.0)}
    places_m = np.concatenate(list(corners_of_known_tags(poses, 0.1).values()))
    return places_m, view.pixels(places_m)


def test_the_place_is_found_from_known_points(scene: OverheadScene) -> None:
    true = scene.true_view()
    found = view_from_known_points(true.lens, *known_points(true))
    assert found.place_m == pytest.approx(true.place_m, abs=1e-4)


def test_a_known_tag_in_another_place_is_named(scene: OverheadScene) -> None:
    true = scene.true_view()
    places_m, pixels = known_points(true)
    moved_m = places_m + np.where(np.arange(12) < 4, 0.2, 0.0)[:, None] * [1, 0, 0]
    with pytest.raises(UserError, match=r"known point at \(0\.\d+, 0\.\d+\) m is seen .* px beside"):
        view_from_known_points(true.lens, moved_m, pixels)


def test_too_few_known_points_are_refused(scene: OverheadScene) -> None:
    true = scene.true_view()
    places_m, pixels = known_points(true)
    with pytest.raises(UserError, match="3 known points are seen and 4 are needed"):
        view_from_known_points(true.lens, places_m[:3], pixels[:3])


def test_a_measured_height_stands_for_the_lens_calibration(scene: OverheadScene) -> None:
    true = scene.true_view()
    lens = replace(true.lens, centre_u_px=959.5, centre_v_px=539.5, distortion=(0.0,) * 5)
    places_m, pixels = known_points(replace(true, lens=lens))
    found = undistorted_lens(places_m, pixels, (1920, 1080), float(true.place_m[2]))
    assert found.focal_u_px == pytest.approx(lens.focal_u_px, rel=1e-3)


def test_a_square_is_fitted_without_changing_its_size() -> None:
    corners_m = np.array([[[0.05, 0.05], [0.05, -0.05], [-0.05, -0.05], [-0.05, 0.05]]]) * 1.2
    (pose,) = fitted_squares(corners_m, 0.1)
    assert (pose.x_m, pose.y_m, pose.theta_rad) == pytest.approx((0.0, 0.0, 0.0))
    assert pose.residual_m == pytest.approx(0.01 * math.sqrt(2))
