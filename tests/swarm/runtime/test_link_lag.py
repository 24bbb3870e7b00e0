"""How far behind a process is, on links that are quick, slow, cut, or between clocks that differ."""

from __future__ import annotations

import math

import pytest

from swarm.clock import NS_PER_S
from swarm.runtime.link_lag import LinkLag

TENTH_NS = NS_PER_S // 10
WAY_NS = 20_000_000


def heard_for(seconds: float, lag: LinkLag, clock_off_ns: int = 0, way_ns: int = WAY_NS) -> int:
    """A message ten times a second; when the last one came."""
    now_ns = 0
    for number in range(1, round(10 * seconds) + 1):
        now_ns = number * TENTH_NS
        lag.heard(7, now_ns - way_ns + clock_off_ns, now_ns)
    return now_ns


def test_before_anything_is_heard_it_is_endlessly_far_behind() -> None:
    assert LinkLag().seconds(5) == math.inf


@pytest.mark.parametrize("clock_off_ns", [0, 3 * NS_PER_S, -3600 * NS_PER_S])
def test_it_grows_from_the_last_message_whatever_the_sender_s_clock_says(clock_off_ns: int) -> None:
    lag = LinkLag()
    now_ns = heard_for(20, lag, clock_off_ns)
    assert lag.seconds(now_ns) == pytest.approx(0.0, abs=0.003)
    assert lag.seconds(now_ns + 3 * TENTH_NS) == pytest.approx(0.3, abs=0.003)


def test_old_messages_that_dribble_in_do_not_count_as_new() -> None:
    lag = LinkLag()
    now_ns = heard_for(10, lag)
    for number in range(1, 4):
        lag.heard(7, now_ns - WAY_NS + number * TENTH_NS // 10, now_ns + number * 2 * TENTH_NS)
    assert lag.seconds(now_ns + 6 * TENTH_NS) == pytest.approx(0.57, abs=0.003)


def test_a_way_that_has_become_longer_is_never_the_usual_one() -> None:
    lag = LinkLag()
    now_ns = heard_for(10, lag)
    for _ in range(600):
        now_ns += TENTH_NS
        lag.heard(7, now_ns - 4 * NS_PER_S, now_ns)
    assert lag.seconds(now_ns) == pytest.approx(3.98, abs=0.01)


def test_clocks_that_drift_apart_are_no_lag() -> None:
    lag, slow = LinkLag(), 50e-6
    for number in range(36_000):
        now_ns = number * TENTH_NS
        lag.heard(7, round(now_ns * (1 - slow)) - WAY_NS, now_ns)
    assert lag.seconds(now_ns) == pytest.approx(0.0, abs=0.001)


def test_the_sender_that_is_heard_best_counts() -> None:
    lag = LinkLag()
    now_ns = heard_for(10, lag)
    lag.heard(8, now_ns, now_ns + TENTH_NS)
    assert lag.seconds(now_ns + 2 * TENTH_NS) == pytest.approx(0.1, abs=0.003)


def test_real_seconds_count_in_a_run_that_is_faster_than_life() -> None:
    lag = LinkLag(speed=10.0)
    now_ns = heard_for(10, lag)
    assert lag.seconds(now_ns + NS_PER_S) == pytest.approx(0.1, abs=0.003)
