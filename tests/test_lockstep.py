"""Lockstep: one message a tick each way, in an order that does not show who was quicker."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from server.lockstep_hub import LockstepHub
from swarm import keys
from swarm.bus import Bus, BusSettings
from swarm.errors import RunFailedError
from swarm.frames import (
    Answer,
    FrameError,
    Tick,
    pack_answer,
    pack_item,
    pack_tick,
    unpack_answer,
    unpack_tick,
)
from swarm.keys import LOCKSTEP_DONE, LOCKSTEP_TICK, Delivery
from swarm.lockstep import LockstepLink, key_matches
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from swarm.presence import Presence, claim
from tests.benchmarks.lockstep import free_endpoint

TICK_S = 0.1


def test_a_star_stands_for_one_part_of_a_key() -> None:
    assert key_matches("robot/*/pose", "robot/a/pose")
    assert key_matches("run/state", "run/state")
    assert not key_matches("robot/*/pose", "robot/a/move")
    assert not key_matches("robot/*/pose", "robot/a/b/pose")
    assert not key_matches("robot/a/pose", "robot/b/pose")


ITEMS = [Item("robot/a/move", Header(1, 2, 3), b"payload"), Item("run/state", Header(1, 1, -1), b"")]


def test_a_frame_says_what_was_packed() -> None:
    items = b"".join(pack_item(*item) for item in ITEMS)
    assert unpack_tick(pack_tick(7, 300, 100, 2) + items) == Tick(7, 300, 100, 2, ITEMS)
    assert unpack_answer(pack_answer(7, "robots-1") + items) == Answer(7, "robots-1", ITEMS)
    assert unpack_answer(pack_answer(0, "tracker")) == Answer(0, "tracker", [])


def test_no_cut_frame_is_read_as_another() -> None:
    frame = pack_answer(7, "robots-1") + pack_item(*ITEMS[0])
    whole = len(pack_answer(7, "robots-1"))
    for size in (size for size in range(len(frame)) if size != whole):
        with pytest.raises(FrameError, match="no answer"):
            unpack_answer(frame[:size])
    with pytest.raises(FrameError, match="no answer"):
        unpack_answer(b"\xff" * 100)
    with pytest.raises(FrameError, match="no tick"):
        unpack_tick(b"\xff" * 100)


class Swarm:
    """A hub here, and processes of one robot each in threads with a session of their own."""

    def __init__(self, stack: ExitStack) -> None:
        self.endpoint = free_endpoint()
        self.stack = stack
        self.bus = stack.enter_context(Bus(BusSettings(self.endpoint, hub=True)))
        claim(self.bus, Presence("server", "server", "here", 1))
        self.warnings: list[str] = []
        self.heard: dict[str, list[tuple[int, str, int]]] = {}

    def hub(self, *processes: str) -> LockstepHub:
        return LockstepHub(self.bus, list(processes), TICK_S, lambda: None, self.warnings.append)

    def start(self, robot: str) -> None:
        """A robot that reports every tick and writes down whatever it hears of moves and orders."""
        thread = threading.Thread(target=self._run, args=(robot,))
        thread.start()
        self.stack.callback(thread.join)

    def _run(self, robot: str) -> None:
        heard = self.heard.setdefault(robot, [])
        with Bus(BusSettings(self.endpoint)) as bus:
            link = LockstepLink(bus, robot)
            moves, orders = link.subscribe(keys.MOVE), link.subscribe(keys.ORDER, robot)
            for number, t_ns in enumerate(link.ticks(), 1):
                heard += [(t_ns, f"move of {move.robot}", move.message.number) for move in moves.take()]
                heard += [(t_ns, "order", order.message.kind) for order in orders.take()]
                link.publish(keys.MOVE, pb.Move(number=number), robot)


@pytest.fixture
def swarm() -> Iterator[Swarm]:
    with ExitStack() as stack:
        yield Swarm(stack)


def test_a_tick_s_messages_are_sorted_and_reach_their_readers_with_the_next(swarm: Swarm) -> None:
    for robot in ("b", "a"):
        swarm.start(robot)
    hub = swarm.hub("b", "a")
    hub.start()
    hub.publish(keys.ORDER, pb.Order(kind=pb.Order.PAUSE), "b")
    batches = []
    for _ in range(3):
        hub.advance()
        batches.append(hub.gather())
    hub.finish()
    swarm.stack.close()
    assert [batch.t_ns for batch in batches] == [100_000_000, 200_000_000, 300_000_000]
    for number, batch in enumerate(batches, 1):
        found = [(item.key, item.header.sequence) for item in batch.items if item.key.startswith("robot/")]
        moves = [("robot/a/move", number), ("robot/b/move", number)]
        assert found == (moves if number > 1 else [*moves, ("robot/b/order", 1)])
        assert all(item.header.t_ns == batch.t_ns for item in batch.items if item.key.endswith("move"))
    assert swarm.heard["a"] == [
        (tick * 100_000_000, f"move of {robot}", tick - 1) for tick in (2, 3) for robot in ("a", "b")
    ]
    assert [entry for entry in swarm.heard["b"] if entry[1] == "order"] == [
        (100_000_000, "order", pb.Order.PAUSE)
    ]


def test_a_repeated_tick_gets_the_same_answer_and_is_not_stepped_again(swarm: Swarm) -> None:
    swarm.start("a")
    hub = swarm.hub("a")
    hub.start()
    hub.advance()
    hub.gather()
    answers = swarm.bus.inbox(LOCKSTEP_DONE, Delivery.EVERY, wake_s=0.05)
    again = swarm.bus.sender(LOCKSTEP_TICK.format(process="a"), Delivery.EVERY)
    again.put(pack_tick(1, 100_000_000, 100_000_000, 1))
    while not (payload := answers.wait()):
        pass
    answer = unpack_answer(payload)
    assert answer.number == 1
    assert [(item.key, item.header.sequence) for item in answer.items] == [("robot/a/move", 1)]
    hub.advance()
    assert [item.header.sequence for item in hub.gather().items] == [2]
    hub.finish()


def test_a_process_that_never_comes_is_named(swarm: Swarm) -> None:
    swarm.start("a")
    times_s = iter(range(0, 100_000, 10))
    hub = LockstepHub(swarm.bus, ["a", "b"], TICK_S, lambda: None, print, lambda: float(next(times_s)))
    with pytest.raises(RunFailedError, match="b did not start within 60 s"):
        hub.start()
    hub.finish()


def test_a_silent_process_is_warned_of_and_given_up(swarm: Swarm) -> None:
    """The hub's clock is laid out by hand: 3 s pass at each look."""
    swarm.start("a")
    times_s = iter(range(0, 100_000, 3))
    hub = LockstepHub(
        swarm.bus, ["a", "silent"], TICK_S, lambda: None, swarm.warnings.append, lambda: float(next(times_s))
    )
    swarm.bus.sender(LOCKSTEP_DONE, Delivery.EVERY).put(pack_answer(0, "silent"))
    hub.start()
    hub.publish(keys.SERVER_EVENT, pb.Event(name="said before"))
    hub.advance()
    with pytest.raises(RunFailedError, match="silent did not answer tick 1 within 30 s"):
        hub.gather()
    assert swarm.warnings[0] == "tick 1 still waits for silent"
    assert [item.key for item in hub.unsent().items] == ["server/event"], "nothing said is lost"
    hub.finish()
