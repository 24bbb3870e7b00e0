"""The watchdog's rules, in time that passes as a test says."""

from __future__ import annotations

from robot_agent.drivers.motors import EPUCK2
from robot_agent.drivers.robot_link import Actuators, LinkError, Reading
from robot_agent.drivers.watchdog import MISTAKE, Watchdog
from robot_agent.drivers.watchdog_messages import Answer, Event, Identity, Request, unpacked
from tests.support.emulated_robot import Clock

TICK_NS = 100_000_000


class TheirLink:
    """Somebody's link to a robot that does what it is told, until it fails in the way that it is given."""

    motors = EPUCK2
    identity = "their robot"

    def __init__(self) -> None:
        self.told: list[tuple[int, int]] = []
        self.fails_with: Exception | None = None

    def exchange(self, actuators: Actuators) -> Reading:
        if self.fails_with:
            raise self.fails_with
        self.told.append((actuators.left, actuators.right))
        return Reading(0, 0)

    def close(self) -> None:
        self.fails_with = None


def watched() -> tuple[TheirLink, Watchdog, Clock, list[bytes]]:
    """A watchdog whose link is open, and what it says."""
    said: list[bytes] = []
    link, clock = TheirLink(), Clock(TICK_NS)
    watchdog = Watchdog(lambda: link, clock.now_ns, said.append)
    watchdog.act()
    link.told.clear()
    return link, watchdog, clock, said


def command(number: int, deadline_ns: int) -> Request:
    return Request(number, drives=True, left=500, right=400, deadline_ns=deadline_ns)


def test_a_command_holds_until_its_deadline_and_then_the_wheels_are_told_to_stand() -> None:
    link, watchdog, clock, _ = watched()
    answer = watchdog.obey(command(1, 3 * TICK_NS))
    assert answer == Answer(1, TICK_NS, Reading(0, 0), 0, 0)
    assert watchdog.due_ns <= 3 * TICK_NS
    clock.t_ns = 3 * TICK_NS
    watchdog.act()
    assert link.told == [(500, 400), (0, 0)]


def test_a_command_after_its_deadline_is_refused_and_counted() -> None:
    link, watchdog, clock, _ = watched()
    clock.t_ns = 5 * TICK_NS
    assert watchdog.obey(command(1, 3 * TICK_NS)).refused == 1
    assert link.told == [(0, 0)]


def test_a_stop_is_obeyed_however_late_it_comes() -> None:
    link, watchdog, clock, _ = watched()
    watchdog.obey(command(1, 3 * TICK_NS))
    clock.t_ns = 2 * TICK_NS
    watchdog.obey(Request(2, drives=True, deadline_ns=0))
    assert link.told[-1] == (0, 0)


def test_a_link_that_was_lost_is_opened_anew_with_the_wheels_standing() -> None:
    link, watchdog, clock, said = watched()
    watchdog.obey(command(1, 3 * TICK_NS))
    link.fails_with = LinkError("unplugged")
    watchdog.obey(command(2, 3 * TICK_NS))
    clock.t_ns = 2 * TICK_NS
    watchdog.act()
    assert link.told == [(500, 400), (0, 0)]
    texts = [message.text for message in map(unpacked, said) if isinstance(message, Event)]
    assert texts == ["link lost: unplugged", "link is back after 0.1 s"]


def test_a_mistake_in_a_links_own_code_does_not_end_the_watchdog() -> None:
    link, watchdog, _, said = watched()
    watchdog.obey(command(1, 3 * TICK_NS))
    link.fails_with = ZeroDivisionError("theirs")
    watchdog.obey(command(2, 3 * TICK_NS))
    assert watchdog.stand()
    assert link.told[-1] == (0, 0)
    texts = [message.text for message in map(unpacked, said) if isinstance(message, Event)]
    assert texts[0] == f"{MISTAKE}: ZeroDivisionError('theirs')"
    assert sum(isinstance(message, Identity) for message in map(unpacked, said)) == 2


def test_an_idle_robot_is_told_to_stand_ten_times_a_second() -> None:
    link, watchdog, clock, _ = watched()
    for _ in range(20):
        watchdog.act()
        clock.t_ns = watchdog.due_ns
    assert link.told == [(0, 0)] * 20
    assert clock.t_ns == 21 * TICK_NS
