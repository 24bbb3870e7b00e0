"""Where the demonstrator stood still."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.demonstration import find_stops
from robot_agent.imitation.trajectory import SmoothedTrajectory, Trajectory

CELL_M = 0.12
FRAME_S = 0.2


def way(*parts: tuple[float, float, float]) -> SmoothedTrajectory:
    """Parts of (duration_s, east_m_s, north_m_s), exactly seen at five frames a second."""
    steps = [np.tile((east, north), (round(duration_s / FRAME_S), 1)) for duration_s, east, north in parts]
    velocity_m_s = np.concatenate(steps)
    xy_m = np.cumsum(velocity_m_s * FRAME_S, axis=0)
    t_ns = np.arange(len(xy_m), dtype=np.int64) * round(FRAME_S * 1e9)
    covariance_m2 = np.tile(1e-4 * np.eye(2), (len(xy_m), 1, 1))
    seen = Trajectory(t_ns, xy_m, covariance_m2)
    return SmoothedTrajectory(t_ns, xy_m, covariance_m2, seen, velocity_m_s)


EAST, NORTH, STOP, REST = (1.2, 0.1, 0.0), (1.2, 0.0, 0.1), (0.4, 0.0, 0.0), (1.8, 0.0, 0.0)


def test_stops_between_drives() -> None:
    stops = find_stops(way(REST, EAST, STOP, NORTH, REST), CELL_M).stops
    assert [(stop.first, stop.last) for stop in stops] == [(0, 8), (15, 16), (23, 31)]


def test_a_blip_is_no_drive() -> None:
    assert len(find_stops(way(REST, (0.4, 0.1, 0.0), REST), CELL_M).stops) == 1


def test_a_drive_with_a_slow_moment_is_no_pair_of_blips() -> None:
    smoothed = way(REST, (0.4, 0.1, 0.0), (0.2, 0.02, 0.0), (0.6, 0.1, 0.0), REST)
    assert len(find_stops(smoothed, CELL_M).stops) == 2


def test_drives_cut_by_the_first_and_last_frame_have_one_end() -> None:
    smoothed = way(EAST, STOP, NORTH, STOP, EAST)
    assert len(find_stops(smoothed, CELL_M).stops) == 2
