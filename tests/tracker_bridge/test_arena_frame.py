"""From a tracking system's axes to the arena's, and back."""

from __future__ import annotations

import math
from itertools import permutations, product

import numpy as np
import pytest

from swarm.config.experiment import TrackerSettings
from swarm.errors import UserError
from swarm.geometry import Pose, wrap_angle_rad
from tests.support.tracked_swarm import tracked_experiment
from tracker_bridge.arena_frame import ArenaFrame, from_rotation_vector, from_xyz_angles, to_xyz_angles
from tracker_bridge.backends.bodies import Body, Roster
from tracker_bridge.protocols.cursor import Quaternion

RIGHT_HANDED = [
    " ".join(sign + name for sign, name in zip(signs, names, strict=True))
    for names in permutations("xyz")
    for signs in product(("", "-"), repeat=3)
    if np.linalg.det(
        np.array(
            [
                [(1 if not s else -1) * (n == axis) for axis in "xyz"]
                for s, n in zip(signs, names, strict=True)
            ]
        )
    )
    > 0
]


def frame(axes: str = "x y z", unit_m: float = 1.0) -> ArenaFrame:
    return ArenaFrame.of(axes, unit_m, (0.3, -0.2), 0.4)


def test_there_are_24_right_handed_ways() -> None:
    assert len(RIGHT_HANDED) == 24


@pytest.mark.parametrize("axes", RIGHT_HANDED)
def test_what_is_seen_of_a_pose_gives_it_back(axes: str) -> None:
    rng = np.random.default_rng(1)
    for x_m, y_m, theta_rad in rng.uniform(-3.0, 3.0, (20, 3)).tolist():
        placed = frame(axes, 0.001).placed(*frame(axes, 0.001).seen(Pose(x_m, y_m, theta_rad), 0.08))
        assert placed.pose.distance_m(Pose(x_m, y_m, 0.0)) < 1e-9
        assert abs(wrap_angle_rad(placed.pose.theta_rad - theta_rad)) < 1e-9
        assert placed.height_m == pytest.approx(0.08)
        assert placed.tilt_rad == pytest.approx(0.0, abs=1e-6)


def test_motives_y_is_up_and_its_z_points_south() -> None:
    motive = ArenaFrame.of("x -z y", 1.0, (0.0, 0.0), 0.0)
    assert motive.point((1.0, 0.08, -2.0)) == pytest.approx((1.0, 2.0, 0.08))
    turned = motive.placed((0.0, 0.0, 0.0), from_rotation_vector((0.0, math.pi / 2, 0.0)))
    assert turned.pose.theta_rad == pytest.approx(math.pi / 2), "counter-clockwise seen from above"


def test_a_body_that_leans_says_so() -> None:
    leaning = frame().placed((0.0, 0.0, 0.0), from_rotation_vector((0.3, 0.0, 0.0)))
    assert leaning.tilt_rad == pytest.approx(0.3)


@pytest.mark.parametrize("axes", ["x y", "x y y", "a b c", "x y -z", "x -y z", "--x y z", ""])
def test_axes_that_are_none_or_mirror_the_arena_are_refused(axes: str) -> None:
    with pytest.raises(ValueError, match=r"mirrors the arena|does not name three axes"):
        ArenaFrame.of(axes, 1.0, (0.0, 0.0), 0.0)


def matrix(rotation: Quaternion) -> np.ndarray:
    x, y, z, w = rotation
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def about(axis: int, angle_rad: float) -> np.ndarray:
    """A rotation about one axis, written out."""
    one, two = (axis + 1) % 3, (axis + 2) % 3
    turned = np.eye(3)
    turned[one, one] = turned[two, two] = math.cos(angle_rad)
    turned[one, two], turned[two, one] = -math.sin(angle_rad), math.sin(angle_rad)
    return turned


def test_vicons_angles_are_about_x_then_y_then_z() -> None:
    rng = np.random.default_rng(2)
    for angles in rng.uniform(-1.5, 1.5, (50, 3)).tolist():
        rotation = from_xyz_angles((angles[0], angles[1], angles[2]))
        product_of_three = about(0, angles[0]) @ about(1, angles[1]) @ about(2, angles[2])
        assert np.allclose(matrix(rotation), product_of_three)
        assert to_xyz_angles(rotation) == pytest.approx(tuple(angles))


def test_a_rotation_vector_longer_than_a_half_turn_is_the_other_way_round() -> None:
    assert np.allclose(matrix(from_rotation_vector((0.0, 0.0, 6.0))), about(2, 6.0))
    assert from_rotation_vector((0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0, 1.0)


def test_a_robots_body_is_the_one_that_the_experiment_names() -> None:
    """A body that bears a robot's name but is not its body is a stranger."""
    roster = Roster(tracked_experiment(TrackerSettings(), ("a", "b"), ("hat 1", "hat 2")), 1.0)
    bodies = [Body(name, (1.0, 0.5, 0.08), (0.0, 0.0, 0.0, 1.0)) for name in ("hat 1", "a", "wand")]
    assert [tracked.robot for tracked in roster.tracked(bodies, 0, 0)] == ["a", "body a", "wand"]


def test_two_robots_cannot_have_one_body() -> None:
    with pytest.raises(UserError, match="two robots have the same body"):
        Roster(tracked_experiment(TrackerSettings(), ("a", "b"), ("hat", "hat")), 1.0)
