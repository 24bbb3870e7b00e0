"""Lockstep virtual time, the side of the processes: time is a message from the hub."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar

from google.protobuf.message import Message

from swarm.bus import Bus
from swarm.errors import RunFailedError
from swarm.feed import Feed
from swarm.frames import FrameError, Tick, pack_answer, pack_item, unpack_tick
from swarm.keys import LOCKSTEP_DONE, LOCKSTEP_TICK, Delivery, Topic
from swarm.link import Sequencer
from swarm.messages.header import Header, Item

M = TypeVar("M", bound=Message)

WAKE_S = 0.25
WAKES_WITHOUT_HUB = 8
EPOCH = 1
"""A process of a lockstep run is started once, so its epoch is the same in every repetition."""


class LockstepLink:
    """Steps when the hub says so, and sends everything it published in one message an exchange.

    Ticks are numbered and idempotent: a repeated tick gets the same answer again.
    """

    def __init__(self, bus: Bus, process: str) -> None:
        self._bus = bus
        self._process = process
        self._ticks = bus.inbox(LOCKSTEP_TICK.format(process=process), Delivery.EVERY, wake_s=WAKE_S)
        self._done = bus.sender(LOCKSTEP_DONE, Delivery.EVERY)
        self._feeds: list[tuple[str, Feed[Any]]] = []
        self._routes: dict[str, tuple[Feed[Any], ...]] = {}
        self._sequencer = Sequencer()
        self._published: list[bytes] = []
        self._answer = b""
        self._number = 0
        self._t_ns = 0
        self.keys_received: set[str] = set()
        """Every key of which this process received a message."""

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Feed[M]:
        feed = Feed(topic)
        self._feeds.append((topic.key(robot), feed))
        return feed

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        key = topic.key(robot)
        header = Header(EPOCH, self._sequencer.following(key), self._t_ns)
        self._published.append(pack_item(key, header, message.SerializeToString()))

    def ticks(self) -> Iterator[int]:
        while (tick := self._next_tick()).steps:
            for t_ns, items in _steps(tick):
                self._t_ns = t_ns
                for item in items:
                    self._deliver(*item)
                yield t_ns
            self._number = tick.number
            self._answer = pack_answer(tick.number, self._process) + b"".join(self._published)
            self._published.clear()
            self._send_answer()

    def _next_tick(self) -> Tick:
        silent_wakes = 0
        while True:
            payload = self._ticks.wait()
            if payload:
                tick = self._read(payload)
                if tick.number > self._number:
                    return tick
                self._send_answer()
                continue
            silent_wakes = 0 if self._hub_is_alive() else silent_wakes + 1
            if silent_wakes >= WAKES_WITHOUT_HUB:
                raise RunFailedError(f"{self._process}: the server is gone, so the simulation cannot go on")
            if self._number == 0:
                self._greet()

    def _read(self, payload: bytes) -> Tick:
        try:
            return unpack_tick(payload)
        except FrameError as error:
            raise RunFailedError(f"{self._process}: the server sent {error}") from error

    def _hub_is_alive(self) -> bool:
        return bool(self._bus.alive("alive/server/**"))

    def _greet(self) -> None:
        """Repeated until the first tick: a message sent right after declaring may be lost."""
        listens_to = sorted({key for key, _ in self._feeds})
        keys = b"".join(pack_item(key, Header(EPOCH, 0, 0), b"") for key in listens_to)
        self._done.put(pack_answer(0, self._process) + keys)

    def _deliver(self, key: str, header: Header, payload: bytes) -> None:
        feeds = self._routes.get(key)
        if feeds is None:
            feeds = tuple(feed for expression, feed in self._feeds if key_matches(expression, key))
            self._routes[key] = feeds
            self.keys_received.add(key)
        for feed in feeds:
            feed.put(key, header, payload)

    def _send_answer(self) -> None:
        if self._answer:
            self._done.put(self._answer)


def _steps(tick: Tick) -> Iterator[tuple[int, list[Item]]]:
    """The times of an exchange, each with what arrives then: one exchange after it was published."""
    waiting = sorted(tick.items)
    exchange_ns = tick.steps * tick.step_ns
    last_ns = tick.t_ns + exchange_ns - tick.step_ns
    for t_ns in range(tick.t_ns, last_ns, tick.step_ns):
        yield t_ns, [item for item in waiting if item.header.t_ns + exchange_ns <= t_ns]
        waiting = [item for item in waiting if item.header.t_ns + exchange_ns > t_ns]
    yield last_ns, waiting


def key_matches(expression: str, key: str) -> bool:
    """Whether a key lies in an expression in which `*` stands for one part."""
    wanted, parts = expression.split("/"), key.split("/")
    return len(wanted) == len(parts) and all(a in ("*", b) for a, b in zip(wanted, parts, strict=True))
