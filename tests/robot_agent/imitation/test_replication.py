"""Segments as motor commands."""

from __future__ import annotations

import math

import pytest

from robot_agent.imitation.replication import Drive, Turn, motor_commands, replicated
from robot_agent.imitation.segments import Segment
from swarm.geometry import Pose

NORTH, EAST = math.pi / 2, 0.0
PATTERN = (Segment(0.0, 0.24, NORTH, 0, 1), Segment(-math.pi / 2, 0.12, EAST, 2, 3))


def test_each_segment_is_a_turn_and_a_drive() -> None:
    assert motor_commands(PATTERN) == (Turn(0.0), Drive(0.24), Turn(-math.pi / 2), Drive(0.12))


def test_with_an_own_heading_the_pattern_is_repeated_as_it_was_seen() -> None:
    start = Pose(1.0, 1.0, -3.0)
    end = replicated(start, motor_commands(PATTERN, start.theta_rad))
    assert (end.x_m, end.y_m, end.theta_rad) == pytest.approx((1.12, 1.24, 0.0))


def test_without_one_it_starts_where_the_robot_faces() -> None:
    end = replicated(Pose(0.0, 0.0, 0.0), motor_commands(PATTERN))
    assert (end.x_m, end.y_m) == pytest.approx((0.24, -0.12))


def test_no_segments_no_commands() -> None:
    assert motor_commands((), 1.0) == ()
