"""Where the demonstrator stood still."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.demonstration import find_stops
from robot_agent.imitation.smoothing import Smoothed

CELL_M = 0.12
FRAME_S = 0.2


def way(*parts: tuple[float, float, float]) -> Smoothed:
    """Parts of (duration_s, east_m_s, north_m_s), exactly seen at five frames a second."""
    steps = [np.tile((east, north), (round(duration_s / FRAME_S), 1)) for duration_s, east, north in parts]
    velocity_m_s = np.concatenate(steps)
    xy_m = np.cumsum(velocity_m_s * FRAME_S, axis=0)
    t_s = np.arange(len(xy_m), dtype=np.float64) * FRAME_S
    return Smoothed(t_s, xy_m, velocity_m_s, np.tile(1e-4 * np.eye(4), (len(xy_m), 1, 1)))


EAST, NORTH, STOP, REST = (1.2, 0.1, 0.0), (1.2, 0.0, 0.1), (0.4, 0.0, 0.0), (1.8, 0.0, 0.0)


def test_stops_between_drives() -> None:
    smoothed = way(REST, EAST, STOP, NORTH, REST)
    stops = find_stops(smoothed, CELL_M)
    assert [(stop.first, stop.last) for stop in stops] == [(0, 8), (15, 16), (23, 31)]


def test_a_blip_is_no_drive() -> None:
    assert len(find_stops(way(REST, (0.4, 0.1, 0.0), REST), CELL_M)) == 1


def test_a_drive_with_a_slow_moment_is_no_pair_of_blips() -> None:
    smoothed = way(REST, (0.4, 0.1, 0.0), (0.2, 0.02, 0.0), (0.6, 0.1, 0.0), REST)
    assert len(find_stops(smoothed, CELL_M)) == 2


def test_drives_cut_by_the_first_and_last_frame_have_one_end() -> None:
    smoothed = way(EAST, STOP, NORTH, STOP, EAST)
    assert len(find_stops(smoothed, CELL_M)) == 2
