"""Which part of an observation is the demonstration."""

from __future__ import annotations

from robot_agent.imitation.demonstration import Place, find_stops, longest_demonstration
from robot_agent.imitation.trajectory import SmoothedTrajectory
from tests.robot_agent.imitation.test_stops import CELL_M, EAST, NORTH, REST, STOP, way

BACK = (14.0, -0.08, 0.08)


def shown(smoothed: SmoothedTrajectory, start_m: Place | None = None) -> list[tuple[int, int]]:
    demonstration = longest_demonstration(find_stops(smoothed, CELL_M), CELL_M, start_m)
    return [(stop.first, stop.last) for stop in demonstration.stops]


def test_the_drive_back_is_left_out() -> None:
    moves = (REST, EAST, STOP, NORTH, STOP, EAST, REST)
    everything = shown(way(*moves))
    assert len(everything) == 4
    assert shown(way(*moves, BACK, REST)) == everything


def test_the_longer_demonstration_of_two() -> None:
    short, long = (REST, EAST, REST), (REST, NORTH, STOP, EAST, REST)
    assert len(shown(way(*short, BACK, *long))) == 3


def test_a_drive_back_alone_shows_nothing() -> None:
    assert len(shown(way(REST, BACK, REST))) < 2


def test_a_long_pause_does_not_end_a_demonstration() -> None:
    assert len(shown(way(REST, EAST, REST, NORTH, STOP, EAST, REST))) == 4


def test_long_way_with_stops_is_no_drive_back() -> None:
    track = [REST, *([EAST, STOP] * 9), REST]
    assert len(shown(way(*track))) == 10


def test_standing_still_shows_nothing() -> None:
    assert len(shown(way(REST))) < 2
    assert shown(way(EAST)) == []


def test_a_false_stop_on_the_way_back() -> None:
    back = ((7.0, -0.08, 0.08), STOP, (7.0, -0.08, 0.08))
    assert len(shown(way(REST, EAST, STOP, NORTH, REST, *back, REST))) == 3


def test_without_stops_only_the_start_tells_a_demonstration_from_a_drive_back() -> None:
    """The first is a demonstration of nine cells that never stops; the second ends where the robot starts."""
    fast = way(REST, NORTH, REST, (11.0, 0.1, 0.0), REST)
    assert len(shown(fast)) == 2
    assert len(shown(fast, start_m=(0.0, 0.0))) == 3
    assert len(shown(fast, start_m=(1.1, 0.12))) == 2
