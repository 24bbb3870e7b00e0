"""Another host's clock: one wrong time counts for nothing, several that agree for a new base."""

from __future__ import annotations

import pytest

from swarm.clock import NS_PER_S
from swarm.runtime.clock_offset import AGREEING, ClockOffset, described

HOUR_S = 3600.0


def heard(clock: ClockOffset, *behind_s: float) -> list[bool]:
    """Ten messages a second, each so far behind this clock when it comes."""
    now_ns = 10**18
    changed = []
    for late_s in behind_s:
        now_ns += NS_PER_S // 10
        changed.append(clock.heard(now_ns - round(late_s * NS_PER_S), now_ns))
    return changed


@pytest.mark.parametrize("behind_s", [HOUR_S, -HOUR_S, 3.0, -1.2, 1.2, 56 * 365 * 24 * HOUR_S])
def test_messages_that_agree_give_the_offset_of_the_quickest(behind_s: float) -> None:
    clock = ClockOffset(can_step=False)
    changed = heard(clock, *(behind_s + way_s for way_s in (0.11, 0.02, 0.15, 0.05, 0.08)))
    assert changed == [False] * (AGREEING - 1) + [True]
    assert clock.ns == pytest.approx((behind_s + 0.02) * NS_PER_S, abs=100)


@pytest.mark.parametrize("wrong_s", [-HOUR_S, HOUR_S])
def test_a_single_wrong_time_changes_nothing_however_often_it_comes(wrong_s: float) -> None:
    clock = ClockOffset(can_step=True)
    assert not any(heard(clock, *([0.1, wrong_s, wrong_s, wrong_s, wrong_s] * 20)))
    assert clock.ns == 0


def test_clocks_that_agree_are_taken_as_they_are() -> None:
    clock = ClockOffset(can_step=False)
    assert not any(heard(clock, *([0.0, 0.4, -0.2, 0.1] * 20)))
    assert clock.ns == 0


def test_a_slow_link_is_not_taken_for_a_clock_that_was_set() -> None:
    """A process keeps its clock, so what comes later than before has waited on its way."""
    running, settable = ClockOffset(can_step=False), ClockOffset(can_step=True)
    for clock in (running, settable):
        heard(clock, 0.1, 0.1, *([2.0] * 20))
    assert (running.ns, settable.ns) == (0, 2 * NS_PER_S)


def test_a_clock_that_is_set_right_again_is_taken_as_it_is() -> None:
    clock = ClockOffset(can_step=True)
    heard(clock, *([HOUR_S] * AGREEING))
    assert clock.ns == 3600 * NS_PER_S
    heard(clock, *([0.1] * AGREEING))
    assert clock.ns == 0


def test_times_of_messages_that_are_doubted_are_not_believed() -> None:
    clock, now_ns = ClockOffset(can_step=True), 10**18
    believed = [clock.on_this_clock(now_ns - 3 * NS_PER_S, now_ns) for _ in range(AGREEING)]
    assert believed == [None] * (AGREEING - 1) + [now_ns]


def test_an_offset_is_said_in_words() -> None:
    assert described(3 * NS_PER_S) == "3.0 s behind"
    assert described(-3600 * NS_PER_S) == "3600.0 s ahead of"
