"""The live hub: who is late, who goes and comes back, and whose clock is wrong."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from server.hubs.live import LiveHub
from swarm.clock import NS_PER_S, unix_clock
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.messages.topics import Delivery
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.zenoh_session import MOST_AT_ONCE, QUEUE_DEPTH, Session, SessionSettings, WireSample
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import experiment_text, learners, write_experiment

HOUR_NS = 3600 * NS_PER_S


class Laboratory:
    """A live hub, and sessions that pretend to be robots and a tracker."""

    def __init__(self, directory: Path, stack: ExitStack) -> None:
        self._stack = stack
        self._endpoint = free_endpoint()
        experiment = Experiment.load(write_experiment(directory, experiment_text(learners(2))))
        hub_session = stack.enter_context(Session(SessionSettings(self._endpoint, hub=True)))
        self.said: list[str] = []
        self.check: Callable[[], None] = lambda: None
        """What the hub looks at while it waits."""
        self._identity = RunIdentity.of(experiment, 0, "0123456789ab")
        self.hub = LiveHub(
            hub_session,
            unix_clock(),
            experiment,
            self._identity,
            lambda: self.check(),
            self.said.append,
            epoch=1,
        )

    @property
    def identity(self) -> str:
        return str(self._identity.fingerprint)

    def session(self) -> Session:
        return self._stack.enter_context(Session(SessionSettings(self._endpoint)))

    def joins(self, kind: str, name: str, epoch: int = 1, identity: str = "") -> Session:
        session = self.session()
        claim(session, Presence(kind, name, "board", epoch, identity or self.identity))
        return session

    def hears_until(self, condition: Callable[[], bool]) -> dict[str, list[bytes]]:
        """All payloads by key, until a condition holds."""
        heard: dict[str, list[bytes]] = {}
        while not condition():
            for item in self.hub.gather().items:
                heard.setdefault(item.key, []).append(item.payload)
        return heard

    def events(self, heard: dict[str, list[bytes]]) -> list[str]:
        return [pb.Event.FromString(payload).name for payload in heard.get("server/event", [])]


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[Laboratory]:
    with ExitStack() as stack:
        yield Laboratory(tmp_path, stack)


def test_a_run_begins_although_one_robot_is_late_and_the_others_talk(laboratory: Laboratory) -> None:
    laboratory.joins("tracker", "bridge")
    early = laboratory.joins("robot", "r0")
    waiting = threading.Thread(target=laboratory.hub.start)
    waiting.start()
    early.publisher("robot/r0/path", Delivery.EVERY).put(b"given", attachment=Header(1, 1, 0).pack())
    talk = early.publisher("robot/r0/command", Delivery.EVERY)
    for number in range(QUEUE_DEPTH + 20_000):
        talk.put(b"", attachment=Header(1, number + 1, number).pack())
    assert waiting.is_alive()
    laboratory.joins("robot", "r1")
    waiting.join()
    path = early.publisher("robot/r0/path", Delivery.EVERY)
    path.put(b"late", attachment=Header(1, 2, 0).pack())
    heard: dict[str, list[bytes]] = {}
    while b"late" not in heard.get("robot/r0/path", []):
        for item in laboratory.hub.gather().items:
            heard.setdefault(item.key, []).append(item.payload)
    assert heard["robot/r0/path"] == [b"given", b"late"], "what must not be lost is in the first batch"


def test_what_was_said_before_the_trial_began_is_kept_although_it_never_begins(
    laboratory: Laboratory,
) -> None:
    """The server is told to leave while it still waits for somebody."""
    early = laboratory.joins("robot", "r0")
    early.publisher("robot/r0/path", Delivery.EVERY).put(b"given", attachment=Header(1, 1, 0).pack())
    looks = iter(range(10))

    def told_to_leave() -> None:
        if next(looks) == 9:
            raise SystemExit

    laboratory.check = told_to_leave
    with pytest.raises(SystemExit):
        laboratory.hub.start()
    assert "robot/r0/path" in [item.key for item in laboratory.hub.unsent().items]


def test_a_poll_is_bounded_and_loses_nothing(laboratory: Laboratory) -> None:
    session = laboratory.joins("robot", "r0")
    inbox = session.inbox("flood", Delivery.EVERY)
    flood = session.publisher("flood", Delivery.EVERY)
    for number in range(3 * MOST_AT_ONCE):
        flood.put(str(number).encode())
    polls: list[list[WireSample]] = []
    while sum(map(len, polls)) < 3 * MOST_AT_ONCE:
        polls.append(inbox.poll())
    assert max(map(len, polls)) <= MOST_AT_ONCE
    assert [sample.payload for poll in polls for sample in poll] == [
        str(number).encode() for number in range(3 * MOST_AT_ONCE)
    ]


def test_who_goes_and_comes_back_is_told_in_one_line_each(laboratory: Laboratory) -> None:
    tracker, first = laboratory.joins("tracker", "bridge"), laboratory.joins("robot", "r0")
    laboratory.joins("robot", "r1")
    laboratory.hub.start()
    first.close()
    heard = laboratory.hears_until(lambda: len(laboratory.said) == 1)
    tracker.close()
    laboratory.hears_until(lambda: len(laboratory.said) == 2)
    laboratory.joins("robot", "r0", epoch=2)
    heard = laboratory.hears_until(lambda: len(laboratory.said) == 3)
    gone = "is gone: its process on host board ended, hangs or lost its connection"
    assert laboratory.said == [f"r0 {gone}", f"the tracker bridge {gone}", "r0 is back, on host board"]
    while "back" not in laboratory.events(heard):
        for item in laboratory.hub.gather().items:
            heard.setdefault(item.key, []).append(item.payload)


def test_a_second_one_under_a_name_waits_until_the_first_has_gone(laboratory: Laboratory) -> None:
    laboratory.joins("tracker", "bridge")
    first = laboratory.joins("robot", "r0")
    laboratory.joins("robot", "r1")
    laboratory.hub.start()
    copied = laboratory.session()
    copied.declare_alive(Presence("robot", "r0", "cellar", 9, laboratory.identity).key)
    laboratory.hears_until(lambda: len(laboratory.said) == 1)
    assert laboratory.said == ["r0 is there already, on host board: one on host cellar is left out"]
    moves = copied.publisher("robot/r0/move", Delivery.EVERY)
    own = first.publisher("robot/r0/move", Delivery.EVERY)
    moves.put(b"copied", attachment=Header(9, 1, 0).pack())
    own.put(b"own", attachment=Header(1, 1, 0).pack())
    heard: dict[str, list[bytes]] = {}
    while "robot/r0/move" not in heard:
        for item in laboratory.hub.gather().items:
            heard.setdefault(item.key, []).append(item.payload)
    assert heard["robot/r0/move"] == [b"own"]
    first.close()
    laboratory.hears_until(lambda: laboratory.said[-1] == "r0 is back, on host cellar")


def test_who_is_not_admitted_is_missing_and_its_messages_are_not_taken_in(laboratory: Laboratory) -> None:
    laboratory.joins("tracker", "bridge")
    laboratory.joins("robot", "r0")
    stranger = laboratory.joins("robot", "r1", epoch=7, identity="aaaa-1-0-bbbb")
    moves = stranger.publisher("robot/r1/move", Delivery.EVERY)
    moves.put(b"foreign", attachment=Header(7, 1, 0).pack())
    waiting = threading.Thread(target=laboratory.hub.start)
    waiting.start()
    while "waiting for r1" not in laboratory.said:
        assert waiting.is_alive()
    stranger.close()
    own = laboratory.joins("robot", "r1", epoch=8)
    waiting.join()
    own.publisher("robot/r1/move", Delivery.EVERY).put(b"own", attachment=Header(8, 1, 0).pack())
    heard: dict[str, list[bytes]] = {}
    while "robot/r1/move" not in heard:
        for item in laboratory.hub.gather().items:
            heard.setdefault(item.key, []).append(item.payload)
    assert heard["robot/r1/move"] == [b"own"]
    assert "robot 'r1' on host 'board' does not take part" in laboratory.said[0]
    assert not any("is gone" in line for line in laboratory.said), "who never took part does not go"


def test_a_clock_that_is_an_hour_ahead_is_measured_and_told_of(laboratory: Laboratory) -> None:
    laboratory.joins("tracker", "bridge")
    robots = [laboratory.joins("robot", name) for name in ("r0", "r1")]
    laboratory.hub.start()
    statuses = [
        robot.publisher(topics.STATUS.key(f"r{number}"), Delivery.EVERY)
        for number, robot in enumerate(robots)
    ]
    status = pb.Status(activity="waiting").SerializeToString()
    sequence = 0
    while not laboratory.said:
        sequence += 1
        for publisher, ahead_ns in zip(statuses, (HOUR_NS, 0), strict=True):
            header = Header(1, sequence, time.time_ns() + ahead_ns)
            publisher.put(status, attachment=header.pack())
        laboratory.hub.gather()
    (line,) = laboratory.said
    measured_s = float(line.split()[5])
    assert 3590.0 < measured_s <= 3600.0, "less by as long as the quickest message took"
    assert line == (
        f"the clock of r0 is {measured_s:.1f} s ahead of the server's: let its host follow a time server"
    )
