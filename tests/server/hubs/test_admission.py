"""Who takes part in a run, and whose messages are the run's."""

from __future__ import annotations

import pytest

from server.hubs.admission import MOST_SAID, MOST_STARTS, Admission
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from swarm.runtime.identity import Fingerprint
from swarm.runtime.liveliness import Presence

RUN = Fingerprint("aaaa", 1, 0, "cccc")


class Door:
    """An admission to a run of two robots, and what it told."""

    def __init__(self) -> None:
        self.told: list[str] = []
        self.admission = Admission(RUN, ["r0", "r1"], self._tell)

    def _tell(self, name: str, text: str, level: pb.Event.Level.ValueType) -> None:
        assert level == pb.Event.WARNING
        self.told.append(f"{name}: {text}")

    def accepts(self, key: str, epoch: int) -> bool:
        return self.admission.accepts(Item(key, Header(epoch, 1, 0), b""))


@pytest.fixture
def door() -> Door:
    return Door()


def test_a_robot_speaks_for_itself_from_the_epoch_on_that_it_is_present_with(door: Door) -> None:
    assert not door.accepts("robot/r0/move", 7)
    assert door.admission.admits(Presence("robot", "r0", "board", 7, str(RUN)))
    assert door.accepts("robot/r0/move", 7)
    assert door.accepts("sim/r0/truth", 7)
    assert not door.accepts("robot/r1/move", 7), "not for another robot"
    assert not door.accepts("robot/r0/order", 7), "not what others say to it"
    assert not door.accepts("robot/r0/move", 8), "not from an epoch that nobody showed"
    assert door.admission.knows(7)
    assert not door.admission.knows(8)


def test_the_tracker_says_where_robots_are_and_nothing_else_for_them(door: Door) -> None:
    assert not door.accepts("robot/r0/pose", 9)
    assert door.admission.admits(Presence("tracker", "bridge", "lab", 9, str(RUN)))
    assert door.accepts("robot/r0/pose", 9)
    assert door.accepts("tracker/event", 9)
    assert not door.accepts("robot/r0/move", 9)


def test_what_the_server_says_comes_from_nowhere_else(door: Door) -> None:
    for kind, name in (("robot", "r0"), ("tracker", "bridge"), ("server", "server")):
        assert door.admission.admits(Presence(kind, name, "lab", 9, str(RUN)))
    for key in ("run/state", "server/event", "robot/r0/order", "sim/r0/carry"):
        assert not door.accepts(key, 9)


def test_an_emulator_says_where_the_bodies_are_that_it_plays(door: Door) -> None:
    assert door.admission.admits(Presence("emulator", "robots", "lab", 4, str(RUN)))
    assert door.accepts("sim/r1/truth", 4)


def test_who_starts_too_often_is_not_believed_any_more(door: Door) -> None:
    for epoch in range(1, MOST_STARTS + 1):
        assert door.admission.admits(Presence("robot", "r0", "board", epoch, str(RUN)))
    assert not door.admission.admits(Presence("robot", "r0", "board", MOST_STARTS + 1, str(RUN)))
    assert door.accepts("robot/r0/move", MOST_STARTS), "the starts before go on"
    assert not door.accepts("robot/r0/move", MOST_STARTS + 1)


def test_a_key_that_nobody_knows_is_left_to_the_recorder(door: Door) -> None:
    assert door.accepts("nobody/knows", 99)


@pytest.mark.parametrize(
    ("kind", "name", "identity", "reason"),
    [
        ("robot", "ghost", str(RUN), "the experiment does not name it; it names r0, r1"),
        ("robot", "r0", "bbbb-2-0-cccc", "its experiment has other settings, its seed is 2 and not 1"),
        (
            "tracker",
            "bridge",
            "aaaa-1-3-dddd",
            "its messages are of another version of the program, its trial",
        ),
        ("robot", "r0", "-", "it does not say of which run it is"),
        ("robot", "r0", "a-b-c-d", "it does not say of which run it is"),
        ("robot", "r0", "aaaa-1-0-cccc-5", "it does not say of which run it is"),
    ],
)
def test_others_do_not_take_part_and_the_reason_is_told_once(
    door: Door, kind: str, name: str, identity: str, reason: str
) -> None:
    for _ in range(2):
        assert not door.admission.admits(Presence(kind, name, "board", 7, identity))
    assert not door.accepts(f"robot/{name}/move", 7)
    told = [text for text in door.told if "does not take part" in text]
    assert len(told) == 1
    assert told[0].startswith(f"refused: {kind} {name!r} on host 'board' does not take part: {reason}")


def test_a_stranger_who_makes_up_epochs_does_not_fill_the_log(door: Door) -> None:
    for epoch in range(2 * MOST_SAID):
        assert not door.accepts("robot/r0/move", epoch + 100)
    assert len(door.told) == 1
    for host in range(2 * MOST_SAID):
        assert not door.admission.admits(Presence("robot", "ghost", f"host{host}", 7, str(RUN)))
    assert len(door.told) == MOST_SAID
