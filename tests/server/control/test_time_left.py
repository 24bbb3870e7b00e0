"""How long a trial will still take."""

from __future__ import annotations

import pytest

from server.control.time_left import TimeLeft
from swarm.clock import NS_PER_S


def test_it_goes_by_the_slowest_learner_and_leaves_pauses_out() -> None:
    left = TimeLeft(moves_wanted=100)
    left.step({"a": 0, "b": 40}, 0, under_way=True)
    assert left.left_s({"a": 0, "b": 40}) == 0.0, "nobody can say yet"
    left.step({"a": 5, "b": 50}, 10 * NS_PER_S, under_way=True)
    left.step({"a": 5, "b": 50}, 500 * NS_PER_S, under_way=False)
    assert left.left_s({"a": 5, "b": 50}) == pytest.approx(190.0)
    assert left.left_s({"a": 100, "b": 100}) == 0.0


def test_moves_that_another_server_saw_made_are_no_pace() -> None:
    left = TimeLeft(moves_wanted=100)
    left.step({"a": 80}, 0, under_way=True)
    left.step({"a": 90}, 20 * NS_PER_S, under_way=True)
    assert left.left_s({"a": 90}) == pytest.approx(20.0)
