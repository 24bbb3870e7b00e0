"""Real or scaled time, the hub's side: everything on the wire, as it comes."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from google.protobuf.message import Message

from server.hubs.admission import Admission
from server.hubs.attendance import Attendance
from server.hubs.clock_watch import ClockWatch
from server.hubs.hub import Batch
from server.hubs.limited_inbox import inboxes_of
from server.hubs.unheard import Unheard, must_not_be_lost
from swarm.clock import WallClock
from swarm.config.experiment import Experiment
from swarm.logs.ending import Receipt, Sender, receipts_of
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import ACCOUNT, RUN_IDENTITY, TABLE, Delivery, Topic, topic_of
from swarm.runtime.account import Account
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import ALIVE_ROBOTS_AND_TRACKERS, present
from swarm.runtime.node import LivePublisher
from swarm.runtime.zenoh_session import QUEUE_DEPTH, Session, WireSample

M = TypeVar("M", bound=Message)

NAMED_EVERY_S = 5.0
"""Who is waited for is named so often: a person sees it, and it fills no screen."""
LAST_WORDS_S = 10.0
"""Real seconds for the closing accounts. An agent gives its own within a tick, on a busy machine later."""


class LiveHub:
    """Hears what the others of the swarm say; a batch is what arrived in one period of the clock.

    `epoch` is the one that the server shows presence with. What the server says itself does not come over the
    wire: there, somebody else says it.
    """

    def __init__(
        self,
        session: Session,
        clock: WallClock,
        experiment: Experiment,
        identity: RunIdentity,
        check: Callable[[], None],
        warn: Callable[[str], None],
        epoch: int,
        earlier: Mapping[Sender, int] | None = None,
    ) -> None:
        self._session = session
        self._clock = clock
        self._ticks: Iterator[int] = clock.ticks(experiment.simulation.tick_s)
        self._check = check
        self._warn = warn
        self._live = LivePublisher(session, clock, epoch)
        self._own: list[Item] = []
        robots = [robot.id for robot in experiment.robot]
        self._inboxes = inboxes_of(session, TABLE, robots, clock.speed, self._tell)
        self._unheard = Unheard(earlier or {})
        self._admission = Admission(identity.fingerprint, robots, self._tell)
        self._admission.admit(earlier or {})
        watch = session.presence_watch(ALIVE_ROBOTS_AND_TRACKERS)
        self._attendance = Attendance(watch, robots, self._admission.admits, self._tell)
        self._clocks = ClockWatch(clock.speed, self._tell)
        self._early: deque[Item] = deque(maxlen=QUEUE_DEPTH)
        self._ended = False
        self._closing = session.inbox(ACCOUNT.format(name="*"), Delivery.EVERY)
        self._accounts: dict[Sender, int] = {}
        self._receipts: list[Receipt] = []
        self._gone: set[int] = set()
        """Epochs of the processes that have given their closing account."""
        session.answer(RUN_IDENTITY, identity.pack())
        self.without_header = 0
        """Messages that were left out because nothing sensible says who sent them when."""

    @property
    def missing(self) -> list[str]:
        return self._attendance.missing

    def start(self, meanwhile: Callable[[], None] = lambda: None) -> None:
        """Wait until every robot of the experiment and a tracker are there; name those that are missing.

        What they send meanwhile is taken in, or Zenoh would have to wait; of it only what must not be lost
        comes with the first batch.
        """
        named_s = time.monotonic()
        self._attendance.look()
        while missing := self.missing:
            self._check()
            meanwhile()
            next(self._ticks)
            self._early.extend(item for item in self._received() if must_not_be_lost(item.key))
            if time.monotonic() - named_s > NAMED_EVERY_S:
                named_s = time.monotonic()
                self._warn(f"waiting for {', '.join(missing)}")

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        self._own.append(self._live.publish(topic, message, robot))
        if isinstance(message, pb.RunState) and message.phase == pb.RunState.ENDED:
            self._ended = True
            self._attendance.dismiss()

    def advance(self) -> None:
        """In real time the processes need no leave."""

    def gather(self) -> Batch:
        t_ns = next(self._ticks)
        if not self._ended:
            self._check()
        items = self._waiting()
        self._clocks.step(items, self._clock.now_ns())
        return Batch(t_ns, items)

    def unsent(self) -> Batch:
        """What has arrived by now, and what the server has said."""
        return Batch(self._clock.now_ns(), self._waiting())

    def finish(self) -> Batch:
        """The run's state ENDED has told the processes already: wait until they have given account."""
        self._attendance.look()
        there = [one.epoch for kind in ("robot", "tracker") for one in present(self._session, kind)]
        leaving = {epoch for epoch in there if self._admission.knows(epoch)}
        deadline_s = time.monotonic() + LAST_WORDS_S
        self._hear_accounts()
        items = self._received()
        while self._is_awaited(leaving) and time.monotonic() < deadline_s:
            next(self._ticks)
            items += self._received()
            self._hear_accounts()
        return Batch(self._clock.now_ns(), items + self._received())

    def _is_awaited(self, leaving: set[int]) -> bool:
        """Whether somebody who leaves has not given account, or has sent more than has come."""
        return bool(leaving - self._gone) or self._unheard.lacks(self._accounts)

    @property
    def recovered(self) -> Mapping[Sender, int]:
        """How many messages of each sender had been lost on their way, and came later."""
        return self._unheard.recovered

    def accounts(self) -> Mapping[Sender, int]:
        """What the processes that have left said, and what the server itself has sent."""
        own = {(key, self._live.epoch): last for key, last in self._live.sent.items()}
        return {sender: last for sender, last in (self._accounts | own).items() if _is_logged(sender[0])}

    def receipts(self) -> Sequence[Receipt]:
        return self._receipts

    def _hear_accounts(self) -> None:
        samples = self._closing.poll()
        self._attendance.look()
        for sample in samples:
            header = Header.unpack(sample.attachment)
            if header is not None and self._admission.knows(header.epoch):
                self._gone.add(header.epoch)
                account = Account.unpack(sample.payload)
                for key, last in account.sent.items():
                    if self._admission.accepts(Item(key, header, b"")):
                        self._accounts[key, header.epoch] = last
                self._receipts += receipts_of(
                    self._admission.robots_of(header.epoch), header.epoch, account.received
                )

    def _tell(self, name: str, text: str, level: pb.Event.Level.ValueType) -> None:
        """An event in the log, and a line for whoever watches unless it is only for the log."""
        self.publish(topics.SERVER_EVENT, pb.Event(level=level, name=name, text=text))
        if level != pb.Event.INFO:
            self._warn(text)

    def _waiting(self) -> list[Item]:
        """What no batch has held yet: from before the trial began, and what has come since the last."""
        items = [*self._early, *self._received()]
        self._early.clear()
        return items

    def _received(self) -> list[Item]:
        """A sender's presence arrives before its first message, and so is looked at after the messages."""
        arrived = [(inbox, list(self._items(inbox.poll()))) for inbox in self._inboxes]
        self._attendance.look()
        now_s, now_ns = time.monotonic(), self._clock.now_ns()
        taken: list[Item] = []
        for inbox, items in arrived:
            new = self._unheard.of(filter(self._admission.accepts, items), now_ns)
            taken += inbox.limited(new, now_s)
        own, self._own = self._own, []
        return taken + own

    def _items(self, samples: Iterable[WireSample]) -> Iterator[Item]:
        for sample in samples:
            header = Header.unpack(sample.attachment)
            if header is None or header.t_ns < 0:
                self.without_header += 1
            else:
                yield Item(sample.key, header, sample.payload)


def _is_logged(key: str) -> bool:
    """Whether a key's messages enter the log."""
    found = topic_of(key)
    return found is not None and found[0].logged
