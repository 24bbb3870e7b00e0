"""How a process of the swarm takes part in a run: it subscribes, publishes, and steps at every tick."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from itertools import chain
from typing import Any, Protocol, TypeVar

from google.protobuf.message import Message

from swarm.clock import WallClock
from swarm.errors import RunFailedError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import ACCOUNT, Delivery, Topic, topic_of
from swarm.runtime.account import Account
from swarm.runtime.clock_offset import ClockOffset, described
from swarm.runtime.link_lag import LinkLag
from swarm.runtime.liveliness import ALIVE_SERVER, ServerWatch
from swarm.runtime.receipts import Receipts
from swarm.runtime.senders import BelievedSenders
from swarm.runtime.spool import Spool
from swarm.runtime.subscription import Subscription
from swarm.runtime.zenoh_session import Inbox, Publisher, Session, WireSample

M = TypeVar("M", bound=Message)

Step = Callable[[int], None]
"""What a process does at a tick, given the run's time in nanoseconds."""


HELD = 64
"""Messages from senders that nobody knows yet: a presence may come a moment after them."""


class Node(Protocol):
    """The same for real time and for lockstep, so that no process knows which it is in."""

    received: Receipts
    """All that has reached this process."""
    run_id: str
    """The run that this process takes part in; empty in a lockstep."""

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        """A subscription of one robot's messages, or of all robots'."""

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        """Send a message under the robot's key."""

    def offset_ns(self, topic: Topic[Any], robot: str = "") -> int:
        """What to add to the times that a topic's sender writes, to have them on this process's clock."""

    def lag_s(self) -> float:
        """Real seconds by which this process is behind what others send; 0 where time is a message."""

    @property
    def losses(self) -> int:
        """How often the connection was lost: what was sent meanwhile never comes."""

    def run(self, step: Step) -> None:
        """Step at every tick, until the run ends.

        Steps come one at a time, perhaps on another thread; once this returns or raises there are no more.
        """


class Sequencer:
    """Numbers the messages of each key from 1."""

    def __init__(self) -> None:
        self._sequences: dict[str, int] = {}

    @property
    def last(self) -> Mapping[str, int]:
        """Key -> the number of its last message."""
        return self._sequences

    def following(self, key: str) -> int:
        """The number of the key's next message."""
        number = self._sequences.get(key, 0) + 1
        self._sequences[key] = number
        return number


class LivePublisher:
    """Sends messages over the network, each with its sender's epoch, its number and the time."""

    def __init__(self, session: Session, clock: WallClock, epoch: int, spool: Spool | None = None) -> None:
        self.epoch = epoch
        self._spool = spool
        self._session = session
        self._clock = clock
        self._sequencer = Sequencer()
        self._publishers: dict[str, Publisher] = {}

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> Item:
        """Send a message under the topic's key, of a robot if it has one; returns what was sent."""
        key = topic.key(robot)
        header = Header(self.epoch, self._sequencer.following(key), self._clock.now_ns())
        item = Item(key, header, message.SerializeToString())
        if self._spool and topic.is_recovered:
            self._spool.put(item)
        self._put(item, topic)
        return item

    def repeat(self, items: Iterable[Item]) -> None:
        """Send the last that earlier starts have sent, as it was, for a server that missed it."""
        by_key: dict[str, list[Item]] = {}
        for item in items:
            by_key.setdefault(item.key, []).append(item)
        for key, of_key in by_key.items():
            if found := topic_of(key):
                topic, _ = found
                for item in of_key[-topic.kept :]:
                    self._put(item, topic)

    def _put(self, item: Item, topic: Topic[Any]) -> None:
        if item.key not in self._publishers:
            session = self._session
            self._publishers[item.key] = (
                session.keeping_publisher(item.key, topic.kept)
                if topic.is_recovered
                else session.publisher(item.key, topic.delivery)
            )
        self._publishers[item.key].put(item.payload, attachment=item.header.pack())

    @property
    def sent(self) -> Mapping[str, int]:
        """Key -> the number of its last message."""
        return self._sequencer.last

    def give_account(self, name: str, received: Receipts) -> None:
        """Tell the server, as the last thing, how much has been sent and received; before it, what earlier
        starts of this process have sent of what must not be lost.
        """
        publisher = self._session.publisher(ACCOUNT.format(name=name), Delivery.EVERY)
        earlier: dict[int, dict[str, int]] = {}
        for item in self._spool.left if self._spool else ():
            earlier.setdefault(item.header.epoch, {})[item.key] = item.header.sequence
        accounts = [(epoch, Account(sent)) for epoch, sent in earlier.items()]
        for epoch, account in [*accounts, (self.epoch, Account(self.sent, received.counts()))]:
            header = Header(epoch, 1, self._clock.now_ns())
            publisher.put(account.pack(), attachment=header.pack())


class LiveNode:
    """Takes part over the network at the pace of a clock: on boards, and in simulation at a given speed."""

    def __init__(
        self,
        session: Session,
        clock: WallClock,
        period_s: float,
        epoch: int,
        run_id: str = "",
        say: Callable[[str], None] = lambda text: None,  # noqa: ARG005
        going_on: Callable[[], None] = lambda: None,
        spool: Spool | None = None,
    ) -> None:
        self.run_id = run_id
        self._going_on = going_on
        self._session = session
        self._say = say
        self._server = ServerWatch(session.presence_watch(ALIVE_SERVER), say)
        self._senders = BelievedSenders(session)
        self._clocks: dict[str, tuple[int, ClockOffset]] = {}
        self._clock = clock
        self._period_s = period_s
        self._live = LivePublisher(session, clock, epoch, spool)
        if spool:
            self._live.repeat(spool.left)
        self._lag = LinkLag(clock.speed)
        self._inboxes: list[tuple[Inbox, Subscription[Any], deque[WireSample]]] = []
        self._first_inbox: dict[str, int] = {}
        """By key expression: what several inboxes hear has come once."""
        self.received = Receipts()
        self._run_states = self.subscribe(topics.RUN_STATE)

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        """A subscription filled at every tick; `*` in a key keeps every message, since it holds many keys."""
        subscription = Subscription(topic)
        self._senders.follow(topic)
        inbox = self._session.inbox(topic.key(robot), topic.delivery, keep_all=robot == "*")
        self._first_inbox.setdefault(topic.key(robot), len(self._inboxes))
        self._inboxes.append((inbox, subscription, deque(maxlen=HELD)))
        return subscription

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        self._live.publish(topic, message, robot)

    def offset_ns(self, topic: Topic[Any], robot: str = "") -> int:
        known = self._clocks.get(topic.key(robot))
        return known[1].ns if known else 0

    def lag_s(self) -> float:
        return self._lag.seconds(self._clock.now_ns())

    @property
    def losses(self) -> int:
        return self._server.losses

    def give_account(self, name: str) -> None:
        """Tell the server, as the last thing, how much this process has sent and received."""
        self._live.give_account(name, self.received)

    def run(self, step: Step) -> None:
        for t_ns in self._clock.ticks(self._period_s):
            self._going_on()
            self._server.look()
            self._take_in()
            states = [state.message for state in self._run_states.take()]
            for state in states:
                self._refuse_another_run(state)
            step(t_ns)
            if any(state.phase == pb.RunState.ENDED for state in states):
                self._say("finished: the run has ended")
                return

    def _refuse_another_run(self, state: pb.RunState) -> None:
        if self.run_id and state.run_id != self.run_id:
            raise RunFailedError(
                f"the server has begun another run ({state.run_id or 'without an id'}), and this process "
                f"takes part in run {self.run_id}: start it again to take part in the new one"
            )

    def _take_in(self) -> None:
        arrived = [inbox.poll() for inbox, _, _ in self._inboxes]
        self._senders.look()
        for sample in chain.from_iterable(arrived[first] for first in self._first_inbox.values()):
            header = Header.unpack(sample.attachment)
            self.received.heard(sample.key, header.epoch if header else 0, sample.payload)
        for samples, (_, subscription, held) in zip(arrived, self._inboxes, strict=True):
            waiting = [*held, *samples]
            held.clear()
            for sample in waiting:
                header = Header.unpack(sample.attachment)
                if header and not self._believes(sample.key, header):
                    held.append(sample)
                else:
                    subscription.put(sample.key, self._on_own_clock(sample.key, header), sample.payload)

    def _believes(self, key: str, header: Header) -> bool:
        found = topic_of(key)
        return found is None or self._senders.believes(*found, header.epoch)

    def _on_own_clock(self, key: str, header: Header | None) -> Header | None:
        """A header whose time is on this clock. (A sender's clock cannot step: only its epochs differ.)"""
        if header is None:
            return None
        self._lag.heard(header.epoch, header.t_ns, self._clock.now_ns())
        epoch, clock = self._clocks.get(key, (0, None))
        if clock is None or epoch != header.epoch:
            clock = ClockOffset(self._clock.speed, can_step=False)
            self._clocks[key] = (header.epoch, clock)
        if clock.heard(header.t_ns, self._clock.now_ns()) and clock.ns:
            self._say(f"warning: the clock that sends {key} is {described(clock.ns)} this one: corrected")
        return header._replace(t_ns=header.t_ns + clock.ns)
