"""Real or scaled time, the hub's side: everything on the wire, as it comes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import TypeVar

from google.protobuf.message import Message

from server.hubs.hub import Batch
from swarm.clock import WallClock
from swarm.config.experiment import Experiment
from swarm.logs.ending import Sender
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header, Item
from swarm.messages.topics import ACCOUNT, Delivery, Topic, topic_of
from swarm.runtime.account import unpack_account
from swarm.runtime.liveliness import present
from swarm.runtime.node import LivePublisher
from swarm.runtime.zenoh_session import Session, WireSample

M = TypeVar("M", bound=Message)

LAST_WORDS_S = 10.0
"""Real seconds for the closing accounts. An agent gives its own within a tick, on a busy machine later."""
EVERYTHING = ("robot/**", "tracker/**", "run/**", "server/**", "sim/**")


class LiveHub:
    """Hears every key of the swarm; a batch is what arrived in one period of the clock."""

    def __init__(
        self,
        session: Session,
        clock: WallClock,
        experiment: Experiment,
        check: Callable[[], None],
        warn: Callable[[str], None],
    ) -> None:
        self._session = session
        self._clock = clock
        self._ticks: Iterator[int] = clock.ticks(experiment.simulation.tick_s)
        self._robots = [robot.id for robot in experiment.robot]
        self._check = check
        self._warn = warn
        self._inboxes = [session.inbox(key, Delivery.EVERY) for key in EVERYTHING]
        self._live = LivePublisher(session, clock, epoch=time.time_ns())
        self._ended = False
        self._closing = session.inbox(ACCOUNT.format(name="*"), Delivery.EVERY)
        self._accounts: dict[Sender, int] = {}
        self._gone: set[int] = set()
        """Epochs of the processes that have given their closing account."""
        self.without_header = 0
        """Messages that were left out because nothing sensible says who sent them when."""

    def start(self) -> None:
        """Wait until every robot of the experiment is alive; name those that are missing."""
        named_s = time.monotonic()
        while missing := sorted(
            set(self._robots) - {presence.name for presence in present(self._session, "robot")}
        ):
            self._check()
            next(self._ticks)
            if time.monotonic() - named_s > 5.0:
                named_s = time.monotonic()
                self._warn(f"waiting for {', '.join(missing)}")

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        self._live.publish(topic, message, robot)
        if isinstance(message, pb.RunState) and message.phase == pb.RunState.ENDED:
            self._ended = True

    def advance(self) -> None:
        """In real time the processes need no leave."""

    def gather(self) -> Batch:
        t_ns = next(self._ticks)
        if not self._ended:
            self._check()
        return Batch(t_ns, [item for inbox in self._inboxes for item in self._items(inbox.poll())])

    def unsent(self) -> Batch:
        """What has arrived by now: the server's own messages come back over the wire like any other."""
        return Batch(
            self._clock.now_ns(), [item for inbox in self._inboxes for item in self._items(inbox.poll())]
        )

    def finish(self) -> Batch:
        """The run's state ENDED has told the processes already: wait until they have given account."""
        leaving = {one.epoch for kind in ("robot", "tracker") for one in present(self._session, kind)}
        deadline_s = time.monotonic() + LAST_WORDS_S
        self._hear_accounts()
        while leaving - self._gone and time.monotonic() < deadline_s:
            next(self._ticks)
            self._hear_accounts()
        return self.unsent()

    def accounts(self) -> Mapping[Sender, int]:
        """What the processes that have left said, and what the server itself has sent."""
        own = {(key, self._live.epoch): last for key, last in self._live.sent.items()}
        return {sender: last for sender, last in (self._accounts | own).items() if _is_logged(sender[0])}

    def _hear_accounts(self) -> None:
        for sample in self._closing.poll():
            header = Header.unpack(sample.attachment)
            if header is not None:
                self._gone.add(header.epoch)
                for key, last in unpack_account(sample.payload).items():
                    self._accounts[key, header.epoch] = last

    def _items(self, samples: list[WireSample]) -> Iterator[Item]:
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
