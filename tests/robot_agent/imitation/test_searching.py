"""Where the observer looks for a demonstrator that is not in the image."""

from __future__ import annotations

import pytest

from robot_agent.imitation.observer import SEARCH_AFTER_NS, SWEEP_RAD, Search
from robot_agent.vision.detector import Detection, NotSeen, Reason

LATE_NS = SEARCH_AFTER_NS + 1


def lost(t_ns: int, reason: Reason = Reason.NOT_SEEN) -> NotSeen:
    return NotSeen(t_ns, reason)


def seen(t_ns: int) -> Detection:
    return Detection(t_ns, 0.5, 0.0, ((1e-6, 0.0), (0.0, 1e-6)), 10.0, 20.0)


def test_for_a_second_it_goes_on_as_before() -> None:
    search = Search(0)
    assert search.towards_rad(lost(SEARCH_AFTER_NS - 1), 1.0, 0.4) == 0.4
    assert search.towards_rad(lost(LATE_NS), 1.0, 0.4) == pytest.approx(1.0 + SWEEP_RAD)


def test_it_turns_at_the_end_of_the_sweep_and_sweeps_about_where_it_began() -> None:
    search = Search(0)
    search.towards_rad(lost(0), 1.0, None)
    goals = [
        search.towards_rad(lost(LATE_NS + n), heading, None) for n, heading in enumerate((1.0, 1.55, 0.45))
    ]
    assert goals == pytest.approx([1.0 + SWEEP_RAD, 1.0 - SWEEP_RAD, 1.0 + SWEEP_RAD])


@pytest.mark.parametrize(("heading_rad", "side"), [(1.2, 1.0), (0.8, -1.0)])
def test_it_begins_on_the_side_where_the_demonstrator_was_last(heading_rad: float, side: float) -> None:
    """By then it has turned to that side."""
    search = Search(0)
    search.towards_rad(seen(0), 1.0, None)
    goal = search.towards_rad(lost(LATE_NS), heading_rad, None)
    assert goal == pytest.approx(1.0 + side * SWEEP_RAD)


def test_a_sighting_ends_the_search_and_gives_a_new_second() -> None:
    search = Search(0)
    search.towards_rad(lost(LATE_NS), 1.0, None)
    assert search.towards_rad(seen(2 * LATE_NS), 1.3, 0.7) == 0.7
    assert search.towards_rad(lost(2 * LATE_NS + SEARCH_AFTER_NS // 2), 1.3, 0.7) == 0.7


@pytest.mark.parametrize("reason", [Reason.DARK, Reason.HIDDEN, Reason.TWO_CANDIDATES, Reason.JUMPED])
def test_turning_does_not_help_against_everything(reason: Reason) -> None:
    assert Search(0).towards_rad(lost(10 * LATE_NS, reason), 1.0, 0.4) == 0.4
