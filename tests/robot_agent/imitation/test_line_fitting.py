"""Regression line fitting with split and merge."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.imitation.line_fitting import (
    fit_line,
    fit_segments,
    merge,
    running_median,
    snap,
    split_at_bends,
)
from robot_agent.imitation.segments import Segment
from robot_agent.imitation.trajectory import Floats, Trajectory
from swarm.geometry import Move

CELL_M = 0.12


def corner(noise_m: float = 0.0) -> Floats:
    """Two cells east, then one cell north."""
    east = np.linspace((0.0, 0.0), (0.24, 0.0), 20)
    north = np.linspace((0.24, 0.0), (0.24, 0.12), 10)
    xy_m = np.concatenate((east, north))
    return xy_m + np.random.default_rng(1).normal(0.0, noise_m, xy_m.shape) if noise_m else xy_m


def trajectory(xy_m: Floats) -> Trajectory:
    t_ns = np.arange(len(xy_m), dtype=np.int64)
    return Trajectory(t_ns, xy_m, np.tile(1e-4 * np.eye(2), (len(xy_m), 1, 1)))


def test_split_finds_the_corner() -> None:
    assert split_at_bends(corner(), 0.03) in ([0, 19, 29], [0, 20, 29])


def test_fit_is_the_total_least_squares_line_in_the_direction_of_travel() -> None:
    xy_m = np.array([[0.3, 0.01], [0.2, -0.01], [0.1, 0.01], [0.0, -0.01]])
    line = fit_line(xy_m, 0, 3)
    assert line.direction[0] < -0.99
    assert line.middle_m == pytest.approx([0.15, 0.0])


def test_merge_joins_neighbours_in_one_direction() -> None:
    xy_m = corner()
    lines = [fit_line(xy_m, 0, 8), fit_line(xy_m, 8, 19), fit_line(xy_m, 20, 29)]
    assert [(line.first, line.last) for line in merge(xy_m, lines)] == [(0, 19), (20, 29)]


def test_segments_meet_at_the_intersection() -> None:
    east, north = fit_segments(trajectory(corner(0.005)), CELL_M)
    assert east.length_m == pytest.approx(0.24, abs=0.01)
    assert north.turn_rad == pytest.approx(math.pi / 2, abs=0.15)
    assert [snap(segment, CELL_M) for segment in (east, north)] == [(Move.E, 2), (Move.N, 1)]


@pytest.mark.parametrize("move", list(Move))
def test_snap_to_the_nearest_heading_and_length(move: Move) -> None:
    for degrees in (-20, 0, 20):
        length_m = 2.4 * CELL_M * math.hypot(move.columns, move.rows)
        segment = Segment(0.0, length_m, move.theta_rad + math.radians(degrees), 0, 0)
        assert snap(segment, CELL_M) == (move, 2)


def test_there_and_back_is_two_segments() -> None:
    xy_m = np.concatenate((np.linspace((0, 0), (0.24, 0), 20), np.linspace((0.24, 0), (0, 0), 20)))
    assert [snap(segment, CELL_M) for segment in fit_segments(trajectory(xy_m), CELL_M)] == [
        (Move.E, 2),
        (Move.W, 2),
    ]


def test_median_removes_a_single_bad_position() -> None:
    xy_m = corner()
    xy_m[7] += 0.3
    assert running_median(xy_m)[7] == pytest.approx(corner()[7], abs=0.03)


@pytest.mark.parametrize("count", [0, 1])
def test_too_few_positions_for_a_line(count: int) -> None:
    assert fit_segments(trajectory(corner()[:count]), CELL_M) == ()


def test_identical_positions_end_in_a_segment_without_length() -> None:
    segments = fit_segments(trajectory(np.full((9, 2), 0.4)), CELL_M)
    assert [segment.length_m for segment in segments] == [0.0]
