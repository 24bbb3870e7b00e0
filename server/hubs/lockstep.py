"""Lockstep virtual time, the hub's side: one message to every process an exchange, one message back."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from queue import Empty, SimpleQueue
from typing import TypeVar

from google.protobuf.message import Message

from server.hubs.hub import Batch
from swarm.clock import NS_PER_S
from swarm.errors import RunFailedError
from swarm.logs.ending import Receipt, Sender
from swarm.messages.header import Header, Item
from swarm.messages.topics import LOCKSTEP_DONE, LOCKSTEP_TICK, Delivery, Topic
from swarm.runtime.lockstep import EPOCH, key_matches
from swarm.runtime.lockstep_frames import BAD_FRAME, TICK, Answer, pack_item, unpack_answer
from swarm.runtime.node import Sequencer
from swarm.runtime.zenoh_session import Session

M = TypeVar("M", bound=Message)

WAKE_S = 0.25
"""How often a hub that hears nothing looks whether its processes live: after hundreds of exchanges."""
NAMED_AFTER_S = 2.0
"""Long for a tick, short for a person; a tick that was lost is sent again then."""
LOST_AFTER_S = 30.0
"""Half the lease: the hub ends the run and says why, before Zenoh closes a connection."""
GREETED_WITHIN_S = 300.0
"""A hundred processes take ten seconds on two busy cores, and a robot with a camera whose kernels nobody has
compiled yet 25 s of its own, on a busy machine a minute (measured). One that died is found out at once."""
GREETING_NAMED_AFTER_S = 15.0
"""A person then wants to know what there is to wait for."""


class LockstepHub:
    """Sends numbered ticks and waits for every process's answer.

    What is published in one exchange (`ticks_per_exchange` ticks) reaches its subscribers with the next;
    both the batch and the process put its items in order, so that neither load nor the number of processes
    shows. `check` raises when a process has died; `warn` is told which process does not answer, `exchanged`
    of every exchange that is over.
    """

    def __init__(
        self,
        session: Session,
        processes: list[str],
        tick_s: float,
        check: Callable[[], None],
        warn: Callable[[str], None],
        monotonic_s: Callable[[], float] = time.monotonic,
        ticks_per_exchange: int = 1,
        exchanged: Callable[[], None] = lambda: None,
    ) -> None:
        self._arrived: SimpleQueue[bytes] = SimpleQueue()
        session.on_arrival(LOCKSTEP_DONE, self._arrived.put)
        self._publishers = {
            name: session.publisher(LOCKSTEP_TICK.format(process=name), Delivery.EVERY) for name in processes
        }
        self._tick_ns = round(tick_s * NS_PER_S)
        self._ticks = ticks_per_exchange
        self._check = check
        self._warn = warn
        self._monotonic_s = monotonic_s
        self._exchanged = exchanged
        self._subscriptions: dict[str, list[str]] = {}
        self._readers: dict[str, tuple[str, ...]] = {}
        self._sequencer = Sequencer()
        self._own: list[Item] = []
        self._to_deliver: dict[str, list[bytes]] = {name: [] for name in processes}
        self._frames: dict[str, bytes] = {}
        self.number = 0
        """The exchange that is under way: one tick, unless there are more to an exchange."""

    @property
    def t_ns(self) -> int:
        """The run's time at the end of the exchange."""
        return self.number * self._ticks * self._tick_ns

    @property
    def missing(self) -> list[str]:
        """The processes that have not greeted."""
        return sorted(set(self._publishers) - set(self._subscriptions))

    def start(self, meanwhile: Callable[[], None] = lambda: None) -> None:
        """Wait for every process's greeting; the first tick answers it."""
        began_s = named_s = self._monotonic_s()
        while missing := self.missing:
            meanwhile()
            greeting = self._next_answer()
            if greeting and greeting.number == 0 and greeting.process in self._publishers:
                self._subscriptions[greeting.process] = [item.key for item in greeting.items]
            self._check()
            now_s = self._monotonic_s()
            if now_s - began_s > GREETED_WITHIN_S:
                raise RunFailedError(f"{', '.join(missing)} did not start within {GREETED_WITHIN_S:g} s")
            if now_s - named_s > GREETING_NAMED_AFTER_S:
                named_s = now_s
                self._warn(f"still waiting for {', '.join(missing)} to start")

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        key = topic.key(robot)
        header = Header(EPOCH, self._sequencer.following(key), self.t_ns)
        item = Item(key, header, message.SerializeToString())
        self._own.append(item)
        self._deliver(item)

    def advance(self) -> None:
        """Send the next tick, and with it to each process what it listens to."""
        first_ns = self.t_ns + self._tick_ns
        self.number += 1
        start = TICK.pack(self.number, first_ns, self._tick_ns, self._ticks)
        for name, items in self._to_deliver.items():
            self._frames[name] = start + b"".join(items)
            self._publishers[name].put(self._frames[name])
            items.clear()
        # Zenoh sends from a thread of its own, which would wait until this one rests.
        os.sched_yield()

    def gather(self) -> Batch:
        """Every message of the tick. A tick that nobody answers is sent again and then given up."""
        waiting = set(self._publishers)
        items: list[Item] = []
        began_s = named_s = self._monotonic_s()
        while waiting:
            answer = self._next_answer()
            if answer is None:
                named_s = self._look_for(waiting, began_s, named_s)
                continue
            number, process, published = answer
            if number == self.number and process in waiting:
                waiting.discard(process)
                items += published
                for item in published:
                    self._deliver(item)
        own, self._own = self._own, []
        self._exchanged()
        return Batch(self.t_ns, items + own)

    def _next_answer(self) -> Answer | None:
        """None when nothing has come for a while, or no answer."""
        try:
            return unpack_answer(self._arrived.get(timeout=WAKE_S))
        except (Empty, *BAD_FRAME):
            return None

    def _deliver(self, item: Item) -> None:
        """Put a message before its readers while other processes still work."""
        readers = self._readers_of(item.key)
        if readers:
            packed = pack_item(*item)
            for name in readers:
                self._to_deliver[name].append(packed)

    def unsent(self) -> Batch:
        own, self._own = self._own, []
        return Batch(self.t_ns, own)

    def finish(self) -> Batch:
        """End every process's ticks. What they had to say came with their answers."""
        end = TICK.pack(self.number + 1, self.t_ns, self._tick_ns, 0)
        for publisher in self._publishers.values():
            publisher.put(end)
        return Batch(self.t_ns, [])

    @property
    def recovered(self) -> Mapping[Sender, int]:
        """Nothing gets lost between two exchanges."""
        return {}

    def accounts(self) -> None:
        """Every answer holds all that its process has sent since the one before."""

    def receipts(self) -> Sequence[Receipt]:
        """Processes write them beside their output, since a log is the same however many there are."""
        return ()

    def _readers_of(self, key: str) -> tuple[str, ...]:
        if key not in self._readers:
            self._readers[key] = tuple(
                name
                for name, expressions in self._subscriptions.items()
                if any(key_matches(expression, key) for expression in expressions)
            )
        return self._readers[key]

    def _look_for(self, waiting: set[str], began_s: float, named_s: float) -> float:
        """Name the processes that are missing: at once if they died, after 2 s if they are silent."""
        names = ", ".join(sorted(waiting))
        try:
            self._check()
        except RunFailedError as error:
            raise RunFailedError(f"{error}; tick {self.number} waits for {names}") from error
        now_s = self._monotonic_s()
        if now_s - began_s > LOST_AFTER_S:
            raise RunFailedError(f"{names} did not answer tick {self.number} within {LOST_AFTER_S:g} s")
        if now_s - named_s > NAMED_AFTER_S - WAKE_S:
            self._warn(f"tick {self.number} still waits for {names}")
            for name in waiting:
                self._publishers[name].put(self._frames[name])
            return now_s
        return named_s
