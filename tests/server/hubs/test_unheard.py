"""What senders repeat is taken in once; what came late is counted."""

from __future__ import annotations

from server.hubs.unheard import LATE_NS, Unheard
from swarm.messages.header import Header, Item

MOVE = "robot/r0/move"


def move(number: int, epoch: int = 5, t_ns: int = 0) -> Item:
    return Item(MOVE, Header(epoch, number, t_ns), b"")


def numbers(items: list[Item]) -> list[tuple[int, int]]:
    return [(item.header.epoch, item.header.sequence) for item in items]


def test_what_earlier_logs_hold_and_what_was_heard_is_left_out() -> None:
    unheard = Unheard({(MOVE, 5): 3})
    heard = unheard.of([move(number) for number in (2, 3, 4, 5, 4, 5, 6)], now_ns=0)
    assert numbers(heard) == [(5, 4), (5, 5), (5, 6)]
    assert numbers(unheard.of([move(1, epoch=7), move(6), move(2, epoch=7)], now_ns=0)) == [(7, 1), (7, 2)]


def test_newest_messages_all_pass() -> None:
    pose = Item("robot/r0/pose", Header(5, 1, 0), b"")
    assert Unheard({}).of([pose, pose], now_ns=0) == [pose, pose]


def test_it_knows_what_is_lacking_by_an_account() -> None:
    unheard = Unheard({})
    unheard.of([move(1), move(2)], now_ns=0)
    assert not unheard.lacks({(MOVE, 5): 2, ("robot/r0/pose", 5): 100})
    assert unheard.lacks({(MOVE, 5): 3})
    assert unheard.lacks({(MOVE, 6): 1})


def test_late_messages_are_counted_whatever_the_sender_s_clock_says() -> None:
    """It is an hour ahead; the messages of two seconds and more were lost at first."""
    unheard, hour_ns = Unheard({}), 3_600_000_000_000
    sent = [(1, 0), (2, LATE_NS // 2), (3, LATE_NS), (4, 2 * LATE_NS)]
    unheard.of([move(1, t_ns=hour_ns)], now_ns=1000)
    unheard.of([move(number, t_ns=hour_ns + t_ns) for number, t_ns in sent[1:]], now_ns=2 * LATE_NS + 1001)
    assert unheard.recovered[MOVE, 5] == 2
