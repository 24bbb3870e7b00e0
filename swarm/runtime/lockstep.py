"""Lockstep virtual time, the side of the processes: time is a message from the hub."""

from __future__ import annotations

import threading
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from google.protobuf.message import Message

from swarm.errors import RunFailedError
from swarm.messages.header import Header, Item
from swarm.messages.topics import LOCKSTEP_DONE, LOCKSTEP_TICK, Delivery, Topic
from swarm.runtime.liveliness import ALIVE_SERVER
from swarm.runtime.lockstep_frames import BAD_FRAME, TICK, pack_answer, pack_item, unpack_items
from swarm.runtime.node import Sequencer, Step
from swarm.runtime.receipts import Receipts
from swarm.runtime.subscription import Subscription
from swarm.runtime.zenoh_session import Session, SessionSettings

M = TypeVar("M", bound=Message)

WAKE_S = 0.25
"""How often the main thread looks whether it is wanted; between two of its looks pass hundreds of ticks."""
WAKES_WITHOUT_HUB = 8
"""2 s without the server's presence, which vanishes with its session."""
LEASE_S = 60.0
"""A process gives no sign of life while it steps; the hub itself finds out who is silent for too long."""
SENT_AT_ONCE_BYTES = 32_768
"""Far below the two batches of 64 KiB that Zenoh holds: with them full its thread would wait for itself."""
EPOCH = 1
"""A process of a lockstep run is started once, so its epoch is the same in every repetition."""


def patient(settings: SessionSettings) -> SessionSettings:
    """Settings of a session, hub's or process's, for a lockstep."""
    return replace(settings, lease_s=LEASE_S)


class LockstepNode:
    """Steps when the hub says so, and sends everything it published in one message an exchange.

    Ticks are numbered and idempotent: a repeated tick gets the same answer again.

    A tick is stepped on the thread on which it arrives, which is Zenoh's. Between two ticks a process has
    nothing else to do, and to hand each tick to the main thread and each answer back takes longer than a
    robot's step. Zenoh's thread must never wait for room in Zenoh's own queue, which it empties itself: it
    sends an answer if that is new and small and nothing else can be waiting. The rest, answers that are
    large or asked for again and greetings, is left to the main thread, as is what a step raises.
    """

    run_id = ""

    def __init__(self, session: Session, process: str) -> None:
        self._session = session
        self._process = process
        self._done = session.publisher(LOCKSTEP_DONE, Delivery.EVERY)
        self._subscriptions: list[tuple[str, Subscription[Any]]] = []
        self._routes: dict[str, tuple[Subscription[Any], ...]] = {}
        self._sequencer = Sequencer()
        self._published: list[bytes] = []
        self._answer = b""
        self._number = 0
        self._t_ns = 0
        self._turn = threading.Lock()
        self._ended = False
        self._error: BaseException | None = None
        self._owed = False
        self._main_sends = False
        self._news = threading.Event()
        self.received = Receipts()

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        subscription = Subscription(topic)
        self._subscriptions.append((topic.key(robot), subscription))
        return subscription

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        key = topic.key(robot)
        header = Header(EPOCH, self._sequencer.following(key), self._t_ns)
        self._published.append(pack_item(key, header, message.SerializeToString()))

    losses = 0

    def lag_s(self) -> float:
        return 0.0

    def offset_ns(self, topic: Topic[Any], robot: str = "") -> int:  # noqa: ARG002
        """All have the same time in a lockstep."""
        return 0

    def run(self, step: Step) -> None:
        self._session.on_arrival(LOCKSTEP_TICK.format(process=self._process), partial(self._on_tick, step))
        try:
            self._wait_for_end()
        finally:
            self._ended = True
            with self._turn:  # A step that is under way comes to its end.
                pass
        if self._error:
            raise self._error

    def _on_tick(self, step: Step, payload: bytes) -> None:
        """On Zenoh's thread, which would swallow an error."""
        with self._turn:
            try:
                if not self._ended:
                    self._follow(step, payload)
            except BaseException as error:
                self._error = error
                self._end()

    def _follow(self, step: Step, payload: bytes) -> None:
        """Make a tick's steps and answer it. If it brings nothing this calls nothing that can be spared."""
        try:
            number, t_ns, step_ns, steps = TICK.unpack_from(payload)
            items = unpack_items(payload, TICK.size) if len(payload) > TICK.size else []
        except BAD_FRAME as error:
            raise RunFailedError(f"{self._process}: the server sent no tick: {error}") from error
        if not steps:
            self._end()
        elif number <= self._number:
            self._owed = True
        else:
            end_ns = t_ns + steps * step_ns
            for step_t_ns in range(t_ns, end_ns, step_ns):
                self._t_ns = step_t_ns
                if items:
                    items = self._deliver_due(items, end_ns - t_ns)
                step(step_t_ns)
            answer = pack_answer(number, self._process) + b"".join(self._published)
            self._published.clear()
            self._number, self._answer = number, answer
            if len(answer) <= SENT_AT_ONCE_BYTES and not self._main_sends:
                self._owed = False
                self._done.put(answer)
            else:
                self._owed = True
                self._news.set()

    def _end(self) -> None:
        self._ended = True
        self._news.set()

    def _wait_for_end(self) -> None:
        """The main thread's part."""
        silent_wakes = 0
        while not self._ended:
            before = self._number
            if self._news.wait(WAKE_S):
                self._news.clear()
                self._send_owed()
            elif not self._turn.locked():
                self._main_sends = False
                silent = self._number == before and not self._hub_is_alive()
                silent_wakes = silent_wakes + 1 if silent else 0
                if silent_wakes == WAKES_WITHOUT_HUB:
                    raise RunFailedError(
                        f"{self._process}: the server is gone, so the simulation cannot go on"
                    )
                if self._number:
                    self._send_owed()
                else:
                    self._greet()

    def _send_owed(self) -> None:
        """This may wait for Zenoh's thread, which therefore sends nothing itself until all has gone."""
        with self._turn:
            owed, self._owed = self._owed, False
            self._main_sends |= owed
        if owed:
            self._done.put(self._answer)

    def _hub_is_alive(self) -> bool:
        return bool(self._session.alive(ALIVE_SERVER))

    def _greet(self) -> None:
        """Repeated until the first tick: a message sent right after declaring may be lost."""
        listens_to = sorted({key for key, _ in self._subscriptions})
        keys = b"".join(pack_item(key, Header(EPOCH, 0, 0), b"") for key in listens_to)
        self._done.put(pack_answer(0, self._process) + keys)

    def _deliver_due(self, waiting: list[Item], exchange_ns: int) -> list[Item]:
        """Deliver what was published an exchange ago or before; return the rest."""
        published_ns = self._t_ns - exchange_ns
        for item in sorted(item for item in waiting if item.header.t_ns <= published_ns):
            self._deliver(*item)
        return [item for item in waiting if item.header.t_ns > published_ns]

    def _deliver(self, key: str, header: Header, payload: bytes) -> None:
        subscriptions = self._routes.get(key)
        if subscriptions is None:
            subscriptions = tuple(
                subscription
                for expression, subscription in self._subscriptions
                if key_matches(expression, key)
            )
            self._routes[key] = subscriptions
        self.received.heard(key, header.epoch, payload)
        for subscription in subscriptions:
            subscription.put(key, header, payload)


def key_matches(expression: str, key: str) -> bool:
    """Whether a key lies in an expression in which `*` stands for one part."""
    wanted, parts = expression.split("/"), key.split("/")
    return len(wanted) == len(parts) and all(a in ("*", b) for a, b in zip(wanted, parts, strict=True))
