"""Corners and the straight segments between them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.imitation.polyline import from_chord
from robot_agent.imitation.segments import Vertex, find_vertices, segments_between
from robot_agent.imitation.trajectory import Floats, SmoothedTrajectory, Stop, Trajectory

CELL_M = 0.12


def between_stops(xy_m: Floats) -> SmoothedTrajectory:
    """With a stop at the first and at the last position."""
    frames = len(xy_m)
    t_ns, covariance_m2 = 200_000_000 * np.arange(frames), np.tile(1e-4 * np.eye(2), (frames, 1, 1))
    seen = Trajectory(t_ns, xy_m, covariance_m2)
    ends = (Stop(0, 0), Stop(frames - 1, frames - 1))
    return SmoothedTrajectory(t_ns, xy_m, covariance_m2, seen, np.zeros((frames, 2)), ends)


def line(start: tuple[float, float], end: tuple[float, float], frames: int = 8) -> Floats:
    return np.linspace(start, end, frames)


def test_a_corner_without_a_stop_is_a_bend() -> None:
    xy_m = np.concatenate((line((0, 0), (0.12, 0)), line((0.12, 0), (0.12, 0.12))))
    vertices = find_vertices(between_stops(xy_m), CELL_M)
    assert [vertex.stopped for vertex in vertices] == [True, False, True]
    assert vertices[1].xy_m == pytest.approx([0.12, 0.0])


def test_a_straight_drive_has_no_bend() -> None:
    xy_m = line((0, 0), (0.17, 0.17)) + np.random.default_rng(1).normal(0, 0.01, (8, 2))
    assert len(find_vertices(between_stops(xy_m), CELL_M)) == 2


def test_turns_and_lengths() -> None:
    corners = [(0.0, 0.0), (0.12, 0.0), (0.12, 0.12), (0.0, 0.0)]
    vertices = [Vertex(np.array(xy), np.eye(2), 10 * i, 10 * i + 5) for i, xy in enumerate(corners)]
    east, north, south_west = segments_between(vertices)
    assert (east.turn_rad, east.length_m, east.heading_rad) == pytest.approx((0.0, 0.12, 0.0))
    assert (north.turn_rad, north.length_m) == pytest.approx((math.pi / 2, 0.12))
    assert south_west.turn_rad == pytest.approx(math.radians(135))
    assert (east.t_start_ns, east.t_end_ns) == (5, 10)


def test_distance_from_a_chord_and_from_a_point() -> None:
    away_m = from_chord(np.array([[0.5, 0.2], [2.0, 0.0]]), np.zeros(2), np.array([1.0, 0.0]))
    assert away_m.tolist() == [[0.0, 0.2], [1.0, 0.0]]
    assert from_chord(np.array([[3.0, 4.0]]), np.zeros(2), np.zeros(2)).tolist() == [[3.0, 4.0]]
