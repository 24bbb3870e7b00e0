"""Rendered pictures against closed forms: perspective, light, shadows, what shows."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from swarm.geometry import Pose
from tests.support.judge.optics import Camera, Lens
from tests.support.judge.rendering import traced, truth
from tests.support.judge.scene import Appearance, Box, Colour, Image, Lamp, Scene

FOV_RAD, HEIGHT_M, FORWARD_M = 0.84, 0.028, 0.03
OBSERVER = Pose(0.3, -0.2, 0.7)
RED: Colour = (0.5, 0.0, 0.0)
PLAIN = Appearance(skirt=RED, skirt_specular=0.0, opening_m=0.0, hat=None)
AMBIENT = Lamp(0.0, 0.0, 3.0, power=0.0, ambient=1.0)
EDGE_PX = 1 / 16  # half a sample on either side of two edges


def grey(value: float) -> Image:
    return np.full((4, 4, 3), value, np.float32)


def camera(width: int = 320, pitch_rad: float = 0.0, roll_rad: float = 0.0, k1: float = 0.0) -> Camera:
    lens = Lens(blur_px=0.0, k1=k1, vignetting=0.0)
    return Camera(width, width * 3 // 4, FOV_RAD, HEIGHT_M, FORWARD_M, pitch_rad, roll_rad, lens)


def scene_at(distance_m: float, bearing_rad: float = 0.0, lamp: Lamp = AMBIENT) -> Scene:
    """A red cylinder before a grey room, seen from the camera on OBSERVER."""
    x_m, y_m = distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad)
    robot = OBSERVER.compose(Pose(FORWARD_M + x_m, y_m, 0.0))
    return Scene(robot, PLAIN, lamp, grey(0.3), grey(0.3))


def redness(picture: Image) -> Image:
    """The part of each pixel that the skirt covers."""
    return (picture[..., 0] - picture[..., 1]) / RED[0]


@pytest.mark.parametrize("distance_m", [0.4, 0.75, 1.5])
@pytest.mark.parametrize("width", [160, 320, 640])
def test_a_cylinder_is_as_wide_as_its_tangents(distance_m: float, width: int) -> None:
    view = camera(width)
    covered = redness(traced(scene_at(distance_m), OBSERVER, view))
    tangent_rad = math.asin(PLAIN.skirt_radius_m / distance_m)
    assert covered[view.height // 2].sum() == pytest.approx(
        2 * view.focal_px * math.tan(tangent_rad), abs=EDGE_PX
    )


@pytest.mark.parametrize("k1", [0.0, -0.1, 0.1])
def test_the_edges_lie_where_lens_and_bearing_put_them(k1: float) -> None:
    view, distance_m, bearing_rad = camera(k1=k1), 0.6, 0.25
    row = redness(traced(scene_at(distance_m, bearing_rad), OBSERVER, view))[view.height // 2]
    tangent_rad = math.asin(PLAIN.skirt_radius_m / distance_m)
    right, left = (math.tan(bearing_rad + sign * tangent_rad) for sign in (-1, 1))
    expected = [view.width / 2 - view.focal_px * r * (1 + k1 * r**2) for r in (left, right)]
    first = int(np.argmax(row > 0))
    assert first + 1 - row[first] == pytest.approx(expected[0], abs=EDGE_PX)
    assert row.sum() == pytest.approx(expected[1] - expected[0], abs=EDGE_PX)


def test_the_skirt_is_as_high_as_its_near_side() -> None:
    view, distance_m = camera(640), 0.5
    column = redness(traced(scene_at(distance_m), OBSERVER, view))[:, view.width // 2]
    near_m = distance_m - PLAIN.skirt_radius_m
    expected = view.focal_px * (PLAIN.skirt_top_m - PLAIN.skirt_bottom_m) / near_m
    assert column.sum() == pytest.approx(expected, abs=0.2)  # the column is half a pixel aside of the axis
    top = view.height / 2 - view.focal_px * (PLAIN.skirt_top_m - HEIGHT_M) / near_m
    assert np.argmax(column > 0.5) == pytest.approx(top, abs=1.0)


@pytest.mark.parametrize("pitch_deg", [-3.0, 0.0, 1.0, 3.0])
@pytest.mark.parametrize("roll_deg", [0.0, 3.0])
def test_the_horizon_follows_pitch_and_roll(pitch_deg: float, roll_deg: float) -> None:
    view = camera(320, math.radians(pitch_deg), math.radians(roll_deg))
    scene = replace(scene_at(-1.0), floor=grey(1.0), panorama=grey(0.0))  # the robot stands behind
    sky = 1 - traced(scene, OBSERVER, view)[..., 0]
    horizon = sky.sum(axis=0)
    column = np.arange(view.width) + 0.5 - view.width / 2
    slope = math.tan(math.radians(roll_deg))
    middle = view.height / 2 - view.focal_px * math.tan(math.radians(pitch_deg)) / math.cos(
        math.radians(roll_deg)
    )
    assert horizon == pytest.approx(middle - slope * column, abs=0.15)


@pytest.mark.parametrize("pitch_rad", [0.0, 0.05])
def test_a_projected_point_is_where_its_ray_goes(pitch_rad: float) -> None:
    view = camera(320, pitch_rad, 0.04, k1=-0.1)
    rows, columns = np.array([3, 120, 237]), np.array([5, 160, 300])
    pixels = view.project(2.5 * view.rays[rows, columns])
    assert pixels == pytest.approx(np.stack([columns, rows], axis=-1), abs=1e-6)


def test_the_floor_is_lit_by_lamberts_law_and_shaded_by_a_box() -> None:
    lamp = Lamp(0.0, 0.0, 2.0, power=0.5, ambient=0.2, reference_m=2.0)
    view = camera(160, pitch_rad=math.pi / 2)  # straight down
    scene = replace(scene_at(-1.0, lamp=lamp), floor=grey(0.4))
    place = view.pose(OBSERVER)
    square = place.x_m**2 + place.y_m**2 + 4.0
    expected = 0.4 * (0.2 + 0.5 * 4.0 / square * 2.0 / math.sqrt(square))
    assert traced(scene, OBSERVER, view)[60, 80] == pytest.approx(expected, rel=2e-3)
    roof = Box(
        place.x_m / 2, place.y_m / 2, math.atan2(place.y_m, place.x_m), 0.02, 0.3, 1.5, (1.0, 1.0, 1.0)
    )
    shaded = replace(scene, boxes=(roof,))
    assert traced(shaded, OBSERVER, view)[60, 80] == pytest.approx(0.4 * 0.2, rel=1e-4)


def test_a_polished_floor_mirrors_the_skirt_by_fresnels_law() -> None:
    view, distance_m = camera(640), 0.5
    scene = replace(scene_at(distance_m), floor_gloss=1.0)
    near_m = distance_m - PLAIN.skirt_radius_m
    mirrored_m = 0.02  # of the skirt's side, as far below the floor as it is above
    slope = (HEIGHT_M + mirrored_m) / near_m
    row = int(view.height / 2 + view.focal_px * slope)
    fresnel = 0.04 + 0.96 * (1 - math.sin(math.atan(slope))) ** 5
    mirrored = traced(scene, OBSERVER, view)[row, view.width // 2]
    assert mirrored[0] == pytest.approx(0.3 * (1 - fresnel) + RED[0] * fresnel, rel=0.01)
    assert mirrored[1] == pytest.approx(0.3 * (1 - fresnel), rel=0.01)


def test_a_glossy_skirt_has_one_highlight_and_a_matt_one_none() -> None:
    x_m, y_m = OBSERVER.x_m, OBSERVER.y_m
    behind = Lamp(x_m, y_m, 0.3, power=0.5)
    matt = scene_at(0.5, lamp=behind)
    glossy = replace(matt, appearance=replace(PLAIN, skirt_specular=0.3))
    view = camera()
    gain = traced(glossy, OBSERVER, view) - traced(matt, OBSERVER, view)
    assert gain.max() > 0.1
    assert gain[..., 0] == pytest.approx(gain[..., 2], abs=1e-6)  # it has the lamp's colour, not the skirt's
    _, column = np.unravel_index(np.argmax(gain[..., 1]), gain.shape[:2])
    assert abs(column - view.width / 2) < 3


def test_truth_is_the_axis_from_the_camera_and_from_the_robot() -> None:
    seen = truth(scene_at(0.8, 0.2), OBSERVER, camera())
    assert (seen.bearing_rad, seen.distance_m) == pytest.approx((0.2, 0.8))
    assert (seen.forward_m, seen.left_m) == pytest.approx(
        (FORWARD_M + 0.8 * math.cos(0.2), 0.8 * math.sin(0.2))
    )
    assert seen.visible_fraction == 1.0


def test_the_visible_fraction_is_that_of_the_skirts_pixels() -> None:
    wide = replace(camera(640), horizontal_fov_rad=1.4)
    narrow = replace(wide, width=440, horizontal_fov_rad=2 * math.atan(220 / wide.focal_px))
    hidden_by = Box(*_beside(0.4, 0.265), OBSERVER.theta_rad, 0.02, 0.04, 0.03, (0.0, 0.0, 0.0))
    scene = replace(scene_at(0.6, math.atan(220 / wide.focal_px) - 0.01))
    covered = replace(scene, boxes=(hidden_by,))
    whole = redness(traced(scene, OBSERVER, wide)).sum()
    for shown in (scene, covered):
        expected = redness(traced(shown, OBSERVER, narrow)).sum() / whole
        assert 0.1 < expected < 0.75
        assert truth(shown, OBSERVER, narrow).visible_fraction == pytest.approx(expected, abs=0.03)


def _beside(distance_m: float, left_m: float) -> tuple[float, float]:
    place = OBSERVER.compose(Pose(FORWARD_M + distance_m, left_m, 0.0))
    return place.x_m, place.y_m


def test_the_yellow_hat_and_the_boards_show_above_the_skirt() -> None:
    look = Appearance(opening_m=0.0, pins=True)
    view, distance_m = camera(640), 0.4
    scene = replace(scene_at(distance_m), appearance=look)
    picture = traced(scene, OBSERVER, view)

    def colour_at(height_m: float, radius_m: float) -> Image:
        row = view.height / 2 - view.focal_px * (height_m - HEIGHT_M) / (distance_m - radius_m)
        colour: Image = picture[int(row), view.width // 2]
        return colour

    assert colour_at(0.03, look.skirt_radius_m) == pytest.approx(look.skirt, abs=1e-3)
    assert colour_at(look.hat_bottom_m + 0.004, look.hat_radius_m) == pytest.approx(look.hat, abs=1e-3)
    assert colour_at(look.skirt_top_m + 0.008, 0.0).max() < 0.05
    sky = picture[: view.height // 4]
    assert (np.abs(sky - 0.3).max(axis=-1) > 0.01).sum() > 20  # the pins
