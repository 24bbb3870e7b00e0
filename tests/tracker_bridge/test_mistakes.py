"""The likely mistake behind poses that make no sense."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from swarm.geometry import Pose, wrap_angle_rad
from tracker_bridge.arena_frame import ArenaFrame, Placement, from_rotation_vector, from_xyz_angles
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.mistakes import likely_mistake, likely_mistakes

ARENA = ArenaFrame.of("x y z", 1.0, (0.0, 0.0), 0.0)


def driven(place: Callable[[Pose], Placement]) -> list[TrackedPose]:
    """A robot that drives a loop of some metres in an arena of 3 x 3 m, as a wrong setting shows it."""
    poses = []
    for number in range(400):
        angle_rad = 0.02 * number
        heading_rad = wrap_angle_rad(angle_rad + math.pi / 2)
        placed = place(Pose(1.5 + 0.6 * math.cos(angle_rad), 1.5 + 0.6 * math.sin(angle_rad), heading_rad))
        poses.append(
            TrackedPose("a", placed.pose, number, height_m=placed.height_m, tilt_rad=placed.tilt_rad)
        )
    return poses


def flat(pose: Pose) -> Placement:
    return Placement(pose, 0.08, 0.0)


def test_poses_that_are_right_suggest_nothing() -> None:
    assert likely_mistakes(driven(flat), 3.0, 3.0) == []


def scaled(factor: float) -> Callable[[Pose], Placement]:
    return lambda true: flat(Pose(factor * true.x_m, factor * true.y_m, true.theta_rad))


def read_as(system: str, declared: str) -> Callable[[Pose], Placement]:
    """A system of some axes, read as if it had others."""
    real, believed = (ArenaFrame.of(axes, 1.0, (0.0, 0.0), 0.0) for axes in (system, declared))
    return lambda true: believed.placed(*real.seen(true, 0.08))


def vector_read_as_angles(true: Pose) -> Placement:
    """A body whose own axes lie across: its rotation vector is long, and no angles at all."""
    across = (1.2, 1.2, 1.2 + 0.3 * true.theta_rad)
    assert from_rotation_vector(across) != from_xyz_angles(across)
    return ARENA.placed((true.x_m, true.y_m, 0.08), from_xyz_angles(across))


@pytest.mark.parametrize(
    ("place", "named"),
    [
        (scaled(1_000.0), "is it in millimetres?"),
        (scaled(10_000.0), "is it in units of 0.1 mm?"),
        (lambda true: flat(Pose(true.x_m, true.y_m, math.degrees(true.theta_rad))), "are they in degrees?"),
        (read_as("x -z y", "x y z"), 'Then it is "x -z y"'),
        (lambda true: flat(Pose(3.0 - true.x_m, true.y_m, true.theta_rad)), "is one axis mirrored?"),
        (lambda true: flat(Pose(-true.x_m, true.y_m, true.theta_rad)), "is x mirrored?"),
        (vector_read_as_angles, "a rotation vector read as angles?"),
        (
            lambda true: flat(Pose(true.x_m, true.y_m, true.theta_rad - 1.0)),
            "body_turn_rad = 1.0",
        ),
    ],
)
def test_each_mistake_is_named(place: Callable[[Pose], Placement], named: str) -> None:
    assert any(named in said for said in likely_mistakes(driven(place), 3.0, 3.0))


def test_the_first_laboratorys_log_is_in_units_of_a_tenth_of_a_millimetre() -> None:
    assert likely_mistake(Pose(9652.0, 9595.0, 0.0), 3.0, 3.0) == "is it in units of 0.1 mm?"
    assert likely_mistake(Pose(965.2, 959.5, 0.0), 3.0, 3.0) == "is it in millimetres?"


def test_robots_that_drive_backwards_as_well_are_right() -> None:
    poses = driven(flat)
    backwards = [
        TrackedPose("b", Pose(p.pose.x_m, p.pose.y_m, wrap_angle_rad(p.pose.theta_rad + math.pi)), 0)
        for p in poses
    ]
    assert likely_mistakes(poses + backwards, 3.0, 3.0) == []
