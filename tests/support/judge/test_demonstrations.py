"""The catalogue's rows and the demonstrations: on the grid, in view, at the paper's rate, repeatable."""

from __future__ import annotations

import math
from itertools import islice, pairwise

import numpy as np
import pytest

from tests.support.judge.conditions import conditions
from tests.support.judge.demonstrations import (
    COMPARTMENT,
    FARTHEST_M,
    NEAREST_M,
    SPEED_M_S,
    frames,
    random_demonstration,
    random_view,
)
from tests.support.judge.rendering import render, truth

FILE = (0.84, 0.028, 0.03)


@pytest.mark.parametrize("name", conditions())
def test_every_row_gives_a_whole_frame_in_which_the_skirt_shows(name: str) -> None:
    condition = conditions()[name]
    camera, generator = condition.camera(*FILE), np.random.default_rng(5)
    observer, robot = random_view(generator, camera)
    scene = condition.scene(robot, generator)
    data = render(scene, observer, camera, condition.sensor, generator)
    assert len(data) == 2 * condition.width * condition.height
    assert len(set(data)) > 50
    assert truth(scene, observer, camera).visible_fraction > 0.9


@pytest.mark.parametrize("forward_m", [0.0, 0.03])
def test_views_are_spread_over_distance_and_bearing_within_the_walls(forward_m: float) -> None:
    camera = conditions()["black hat"].camera(0.84, 0.028, forward_m)
    generator = np.random.default_rng(2)
    views = [random_view(generator, camera) for _ in range(400)]
    seen = [camera.pose(observer).relative(robot) for observer, robot in views]
    distances_m = np.array([math.hypot(place.x_m, place.y_m) for place in seen])
    bearings_rad = np.array([math.atan2(place.y_m, place.x_m) for place in seen])
    assert distances_m.min() > NEAREST_M
    assert distances_m.max() < FARTHEST_M
    assert distances_m.mean() == pytest.approx((NEAREST_M + FARTHEST_M) / 2, abs=0.05)
    assert np.abs(bearings_rad).max() < 0.3
    assert bearings_rad.std() == pytest.approx(0.3 / math.sqrt(3), rel=0.1)  # of an even spread
    assert all(COMPARTMENT.state_at(pose.x_m, pose.y_m) is not None for view in views for pose in view)


def test_rows_share_the_room_of_a_seed() -> None:
    rows = conditions()
    camera = rows["black hat"].camera(*FILE)
    _, robot = random_view(np.random.default_rng(5), camera)
    plain, hard = (rows[name].scene(robot, np.random.default_rng(6)) for name in ("black hat", "hard"))
    assert plain.boxes == hard.boxes
    assert plain.lamp == hard.lamp
    assert (plain.floor == hard.floor).all()
    assert (len(plain.posts), len(hard.posts)) == (0, 6)


@pytest.mark.parametrize("seed", range(5))
def test_a_demonstration_walks_the_grid_in_view(seed: int) -> None:
    camera = conditions()["black hat"].camera(*FILE)
    shown = random_demonstration(np.random.default_rng(seed), camera)
    for move, (start, end) in zip(shown.moves, pairwise(shown.corners), strict=True):
        length_m = 0.12 * math.hypot(move.columns, move.rows)
        assert start.distance_m(end) == pytest.approx(length_m)
        assert COMPARTMENT.state_at(end.x_m, end.y_m) is not None
    assert np.diff(shown.times_s) == pytest.approx(0.2)
    for corner in shown.corners:
        seen = camera.pose(shown.observer).relative(corner)
        assert NEAREST_M <= math.hypot(seen.x_m, seen.y_m) <= FARTHEST_M
        assert abs(math.atan2(seen.y_m, seen.x_m)) < camera.horizontal_fov_rad / 2


def test_the_robot_stands_then_never_drives_faster_than_its_speed() -> None:
    camera = conditions()["black hat"].camera(*FILE)
    shown = random_demonstration(np.random.default_rng(3), camera)
    steps_m = np.array([a.distance_m(b) for a, b in pairwise(shown.poses)])
    assert steps_m.max() == pytest.approx(SPEED_M_S * 0.2)
    assert steps_m[:7].max() == steps_m[-7:].max() == 0.0
    driven_m = sum(a.distance_m(b) for a, b in pairwise(shown.corners))
    assert steps_m.sum() == pytest.approx(driven_m, rel=0.02)  # a frame's step may cut a corner


def test_a_film_is_repeatable_and_tells_where_the_robot_was() -> None:
    condition = conditions()["hard"]
    camera = condition.camera(*FILE)
    shown = random_demonstration(np.random.default_rng(3), camera)
    films = [list(islice(frames(shown, condition, camera, np.random.default_rng(4)), 9)) for _ in range(2)]
    assert films[0] == films[1]
    for frame, pose in zip(films[0], shown.poses, strict=False):
        seen = shown.observer.relative(pose)
        assert (frame.truth.forward_m, frame.truth.left_m) == pytest.approx((seen.x_m, seen.y_m))
