"""Stops, and the beginning and end of a demonstration."""

from __future__ import annotations

import numpy as np

from robot_agent.imitation.rests import demonstration_rests, find_rests
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
BACK = (14.0, -0.08, 0.08)


def test_stops_between_drives() -> None:
    smoothed = way(REST, EAST, STOP, NORTH, REST)
    rests = find_rests(smoothed, CELL_M)
    assert [(rest.first, rest.last) for rest in rests] == [(0, 8), (15, 16), (23, 31)]


def test_a_blip_is_no_drive() -> None:
    assert len(find_rests(way(REST, (0.4, 0.1, 0.0), REST), CELL_M)) == 1


def test_a_drive_with_a_slow_moment_is_no_pair_of_blips() -> None:
    smoothed = way(REST, (0.4, 0.1, 0.0), (0.2, 0.02, 0.0), (0.6, 0.1, 0.0), REST)
    assert len(find_rests(smoothed, CELL_M)) == 2


def test_drives_cut_by_the_first_and_last_frame_have_one_end() -> None:
    smoothed = way(EAST, STOP, NORTH, STOP, EAST)
    assert len(find_rests(smoothed, CELL_M)) == 2


def shown(smoothed: Smoothed) -> list[tuple[int, int]]:
    rests = demonstration_rests(smoothed, find_rests(smoothed, CELL_M), CELL_M)
    return [(rest.first, rest.last) for rest in rests]


def test_the_drive_back_is_left_out() -> None:
    moves = (REST, EAST, STOP, NORTH, STOP, EAST, REST)
    everything = shown(way(*moves))
    assert len(everything) == 4
    assert shown(way(*moves, BACK, REST)) == everything


def test_the_longer_demonstration_of_two() -> None:
    short, long = (REST, EAST, REST), (REST, NORTH, STOP, EAST, REST)
    assert len(shown(way(*short, BACK, *long))) == 3


def test_a_drive_back_alone_shows_nothing() -> None:
    assert shown(way(REST, BACK, REST)) == []


def test_a_long_pause_does_not_end_a_demonstration() -> None:
    assert len(shown(way(REST, EAST, REST, NORTH, STOP, EAST, REST))) == 4


def test_long_way_with_stops_is_no_drive_back() -> None:
    track = [REST, *([EAST, STOP] * 9), REST]
    assert len(shown(way(*track))) == 10


def test_standing_still_shows_nothing() -> None:
    assert shown(way(REST)) == []
