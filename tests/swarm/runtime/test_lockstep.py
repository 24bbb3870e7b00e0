"""Lockstep: one message a tick each way, in an order that does not show who was quicker."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from itertools import count
from queue import SimpleQueue

import pytest

from server.hubs.lockstep import LockstepHub
from swarm.errors import RunFailedError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import LOCKSTEP_DONE, LOCKSTEP_TICK, Delivery
from swarm.runtime.liveliness import Presence, claim
from swarm.runtime.lockstep import SENT_AT_ONCE_BYTES, LockstepNode, key_matches
from swarm.runtime.lockstep_frames import (
    BAD_FRAME,
    TICK,
    Answer,
    pack_answer,
    pack_item,
    unpack_answer,
    unpack_items,
)
from swarm.runtime.node import Step
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint

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
    assert unpack_items(TICK.pack(7, 300, 100, 2) + items, TICK.size) == ITEMS
    assert unpack_answer(pack_answer(7, "robots-1") + items) == Answer(7, "robots-1", ITEMS)
    assert unpack_answer(pack_answer(0, "tracker")) == Answer(0, "tracker", [])


def test_no_cut_frame_is_read_as_another() -> None:
    frame = pack_answer(7, "robots-1") + pack_item(*ITEMS[0])
    whole = len(pack_answer(7, "robots-1"))
    for size in (size for size in range(len(frame)) if size != whole):
        with pytest.raises(BAD_FRAME):
            unpack_answer(frame[:size])
    with pytest.raises(BAD_FRAME):
        unpack_answer(b"\xff" * 100)
    with pytest.raises(BAD_FRAME):
        unpack_items(b"\xff" * 100, TICK.size)


def run(node: LockstepNode, step: Step, raised: list[Exception]) -> None:
    """A process's main thread; what it raises is kept."""
    try:
        node.run(step)
    except Exception as error:
        raised.append(error)


class Swarm:
    """A hub here, and processes of one robot each in threads with a session of their own."""

    def __init__(self, stack: ExitStack) -> None:
        self.endpoint = free_endpoint()
        self.stack = stack
        self.session = stack.enter_context(Session(SessionSettings(self.endpoint, hub=True)))
        claim(self.session, Presence("server", "server", "here", 1))
        self.warnings: list[str] = []
        self.heard: dict[str, list[tuple[int, str, int]]] = {}
        self.raised: list[Exception] = []

    def hub(self, *processes: str) -> LockstepHub:
        return LockstepHub(self.session, list(processes), TICK_S, lambda: None, self.warnings.append)

    def start(self, robot: str, step_of: Callable[[LockstepNode], Step] | None = None) -> None:
        """A robot that reports every tick and writes down what it hears, or steps as told."""
        thread = threading.Thread(target=self._run, args=(robot, step_of or partial(self._reporter, robot)))
        thread.start()
        self.stack.callback(thread.join)

    def _run(self, robot: str, step_of: Callable[[LockstepNode], Step]) -> None:
        with Session(SessionSettings(self.endpoint)) as session:
            node = LockstepNode(session, robot)
            run(node, step_of(node), self.raised)

    def _reporter(self, robot: str, node: LockstepNode) -> Step:
        heard = self.heard.setdefault(robot, [])
        moves, orders = node.subscribe(topics.MOVE), node.subscribe(topics.ORDER, robot)
        numbers = count(1)

        def step(t_ns: int) -> None:
            heard.extend((t_ns, f"move of {move.robot}", move.message.number) for move in moves.take())
            heard.extend((t_ns, "order", order.message.kind) for order in orders.take())
            node.publish(topics.MOVE, pb.Move(number=next(numbers)), robot)

        return step


@pytest.fixture
def swarm() -> Iterator[Swarm]:
    with ExitStack() as stack:
        yield Swarm(stack)


def test_a_tick_s_messages_are_sorted_and_reach_their_readers_with_the_next(swarm: Swarm) -> None:
    for robot in ("b", "a"):
        swarm.start(robot)
    hub = swarm.hub("b", "a")
    hub.start()
    hub.publish(topics.ORDER, pb.Order(kind=pb.Order.PAUSE), "b")
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
    answers: SimpleQueue[bytes] = SimpleQueue()
    swarm.session.on_arrival(LOCKSTEP_DONE, answers.put)
    again = swarm.session.publisher(LOCKSTEP_TICK.format(process="a"), Delivery.EVERY)
    again.put(TICK.pack(1, 100_000_000, 100_000_000, 1))
    answer = unpack_answer(answers.get())
    assert answer.number == 1
    assert [(item.key, item.header.sequence) for item in answer.items] == [("robot/a/move", 1)]
    hub.advance()
    assert [item.header.sequence for item in hub.gather().items] == [2]
    hub.finish()


def test_an_answer_of_any_size_arrives(swarm: Swarm) -> None:
    """More than Zenoh's thread may send itself, and more than Zenoh's queue holds."""
    event = pb.Event(level=pb.Event.INFO, text="x" * 2 * SENT_AT_ONCE_BYTES)

    def talker(node: LockstepNode) -> Step:
        def step(t_ns: int) -> None:  # noqa: ARG001
            for _ in range(64):
                node.publish(topics.EVENT, event, "a")

        return step

    swarm.start("a", talker)
    hub = swarm.hub("a")
    hub.start()
    for _ in range(3):
        hub.advance()
        assert [item.payload for item in hub.gather().items] == [event.SerializeToString()] * 64
    hub.finish()


def test_ticks_repeated_at_once_are_answered_once_more(swarm: Swarm) -> None:
    """Twenty answers, each near the most that Zenoh's thread sends itself, would fill its queue."""
    event = pb.Event(level=pb.Event.INFO, text="x" * (SENT_AT_ONCE_BYTES - 1000))

    def talker(node: LockstepNode) -> Step:
        return lambda t_ns: node.publish(topics.EVENT, event, f"a{t_ns}")

    swarm.start("a", talker)
    hub = swarm.hub("a")
    answers: SimpleQueue[bytes] = SimpleQueue()
    swarm.session.on_arrival(LOCKSTEP_DONE, answers.put)
    hub.start()
    hub.advance()
    again = swarm.session.publisher(LOCKSTEP_TICK.format(process="a"), Delivery.EVERY)
    for _ in range(20):
        again.put(TICK.pack(1, 100_000_000, 100_000_000, 1))
    hub.gather()
    numbers = [unpack_answer(answers.get()).number]
    while numbers.count(1) < 2:
        numbers.append(unpack_answer(answers.get()).number)
    hub.advance()
    assert [item.key for item in hub.gather().items] == ["robot/a200000000/event"]
    hub.finish()
    while not answers.empty():
        numbers.append(unpack_answer(answers.get()).number)
    assert numbers.count(1) < 20


class FailingStep:
    """A step that writes its time down and raises."""

    def __init__(self) -> None:
        self.times_ns: list[int] = []

    def __call__(self, t_ns: int) -> None:
        self.times_ns.append(t_ns)
        raise ZeroDivisionError(t_ns)


def test_what_a_step_raises_ends_the_process_and_no_other_step_is_made(swarm: Swarm) -> None:
    step = FailingStep()
    ticks: SimpleQueue[bytes] = SimpleQueue()
    with Session(SessionSettings(swarm.endpoint)) as session:
        node = LockstepNode(session, "a")
        raised: list[Exception] = []
        process = threading.Thread(target=run, args=(node, step, raised))
        process.start()
        hub = swarm.hub("a")
        hub.start()
        hub.advance()
        process.join()
        session.on_arrival(LOCKSTEP_TICK.format(process="a"), ticks.put)
        hub.advance()
        while TICK.unpack_from(ticks.get())[0] != hub.number:
            pass
    assert [repr(error) for error in raised] == ["ZeroDivisionError(100000000)"]
    assert step.times_ns == [100_000_000]


LEAVER = """
import os, signal, sys
from swarm.runtime.zenoh_session import Session, SessionSettings
from swarm.runtime.lockstep import LockstepNode
from swarm.signals import leave_on_signals

def step(t_ns):
    os.kill(os.getpid(), signal.SIGTERM)
    for _ in range(10_000_000):
        "The main thread has its turns meanwhile."
    print("stepped")

leave_on_signals()
with Session(SessionSettings(sys.argv[1])) as session:
    try:
        LockstepNode(session, "a").run(step)
    finally:
        print("left")
"""


def test_a_process_that_is_told_to_leave_ends_its_step_first(swarm: Swarm) -> None:
    leaver = subprocess.Popen(
        [sys.executable, "-c", LEAVER, swarm.endpoint], stdout=subprocess.PIPE, text=True
    )
    hub = swarm.hub("a")
    hub.start()
    hub.advance()
    assert leaver.communicate()[0] == "stepped\nleft\n"
    assert leaver.returncode == 128 + signal.SIGTERM


SLOW = """
import argparse, sys, time
from swarm.runtime.identity import RunIdentity
from swarm.runtime.zenoh_session import SessionSettings
from swarm.runtime.process import add_common_arguments, joined

def step(t_ns):
    end_s = time.monotonic() + 2 * SessionSettings("").lease_s
    while time.monotonic() < end_s:
        "Zenoh's thread gives no sign of life meanwhile."

parser = argparse.ArgumentParser()
add_common_arguments(parser)
words = ["none.toml", "--lockstep", "--process", "a", "--connect", sys.argv[1]]
identity = RunIdentity({"run.seed": "1"}, 0, "schema")
with joined(parser.parse_args(words), "robot", ["a"], 0.1, identity) as link:
    link.run(step)
"""


def test_a_process_stays_present_while_it_steps(swarm: Swarm) -> None:
    process = subprocess.Popen([sys.executable, "-c", SLOW, swarm.endpoint])
    answers: list[bytes] = []
    swarm.session.on_arrival(LOCKSTEP_DONE, answers.append)
    hub = swarm.hub("a")
    hub.start()
    hub.advance()
    while not any(unpack_answer(answer).number == 1 for answer in answers):
        assert swarm.session.alive("alive/robot/**")
    hub.gather()
    hub.finish()
    assert process.wait() == 0


def test_bytes_that_are_no_tick_end_the_process_with_a_clear_line(swarm: Swarm) -> None:
    swarm.start("a")
    hub = swarm.hub("a")
    hub.start()
    swarm.session.publisher(LOCKSTEP_TICK.format(process="a"), Delivery.EVERY).put(b"no tick")
    swarm.stack.pop_all().close()
    assert [str(error)[:30] for error in swarm.raised] == ["a: the server sent no tick: un"]


def test_a_process_that_never_comes_is_named(swarm: Swarm) -> None:
    swarm.start("a")
    times_s = iter(range(0, 100_000, 10))
    said: list[str] = []
    hub = LockstepHub(
        swarm.session, ["a", "b"], TICK_S, lambda: None, said.append, lambda: float(next(times_s))
    )
    with pytest.raises(RunFailedError, match="b did not start within 300 s"):
        hub.start()
    hub.finish()
    assert said[-1] == "still waiting for b to start"


def test_a_silent_process_is_warned_of_and_given_up(swarm: Swarm) -> None:
    """The hub's clock is laid out by hand: 3 s pass at each look."""
    swarm.start("a")
    times_s = iter(range(0, 100_000, 3))
    hub = LockstepHub(
        swarm.session,
        ["a", "silent"],
        TICK_S,
        lambda: None,
        swarm.warnings.append,
        lambda: float(next(times_s)),
    )
    swarm.session.publisher(LOCKSTEP_DONE, Delivery.EVERY).put(pack_answer(0, "silent"))
    hub.start()
    hub.publish(topics.SERVER_EVENT, pb.Event(level=pb.Event.INFO, name="said before"))
    hub.advance()
    with pytest.raises(RunFailedError, match="silent did not answer tick 1 within 30 s"):
        hub.gather()
    assert swarm.warnings[0] == "tick 1 still waits for silent"
    assert [item.key for item in hub.unsent().items] == ["server/event"], "nothing said is lost"
    hub.finish()
