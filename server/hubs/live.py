"""Real or scaled time, the hub's side: everything on the wire, as it comes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from google.protobuf.message import Message

from server.hubs.admission import Admission
from server.hubs.hub import Batch
from swarm.clock import WallClock
from swarm.config.experiment import Experiment
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import RUN_IDENTITY, Delivery, Topic
from swarm.runtime.identity import RunIdentity
from swarm.runtime.liveliness import parsed, present
from swarm.runtime.node import LivePublisher
from swarm.runtime.zenoh_session import Session, WireSample

M = TypeVar("M", bound=Message)

EVERYTHING = ("robot/**", "tracker/**", "run/**", "server/**", "sim/**")
THOSE_WHO_TAKE_PART = ("alive/robot/**", "alive/tracker/**")


class LiveHub:
    """Hears every key of the swarm; a batch is what arrived in one period of the clock."""

    def __init__(
        self,
        session: Session,
        clock: WallClock,
        experiment: Experiment,
        identity: RunIdentity,
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
        epoch = time.time_ns()
        self._live = LivePublisher(session, clock, epoch)
        self._admission = Admission(identity.fingerprint, self._robots, epoch, self._tell)
        self._arrivals = [session.arrivals(key) for key in THOSE_WHO_TAKE_PART]
        session.answer(RUN_IDENTITY, identity.pack())
        self.without_header = 0
        """Messages that were left out because nothing sensible says who sent them when."""

    def start(self) -> None:
        """Wait until every robot of the experiment is alive; name those that are missing."""
        named_s = time.monotonic()
        while missing := sorted(set(self._robots) - self._taking_part()):
            self._check()
            self._admit_arrivals()
            next(self._ticks)
            if time.monotonic() - named_s > 5.0:
                named_s = time.monotonic()
                self._warn(f"waiting for {', '.join(missing)}")

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        self._live.publish(topic, message, robot)

    def advance(self) -> None:
        """In real time the processes need no leave."""

    def gather(self) -> Batch:
        t_ns = next(self._ticks)
        self._check()
        return Batch(t_ns, self._received())

    def unsent(self) -> Batch:
        """What has arrived by now: the server's own messages come back over the wire like any other."""
        return Batch(self._clock.now_ns(), self._received())

    def finish(self) -> None:
        """The run's state ENDED has told the robots already."""

    def _received(self) -> list[Item]:
        """A sender's presence arrives before its first message, and so is looked at after the messages."""
        items = [item for inbox in self._inboxes for item in self._items(inbox.poll())]
        self._admit_arrivals()
        return [item for item in items if self._admission.accepts(item)]

    def _taking_part(self) -> set[str]:
        """The robots of this run that are alive now."""
        there = present(self._session, "robot")
        return {presence.name for presence in there if self._admission.admits(presence)}

    def _admit_arrivals(self) -> None:
        for arrivals in self._arrivals:
            for presence in parsed(sample.key for sample in arrivals.poll()):
                self._admission.admits(presence)

    def _tell(self, name: str, text: str, level: pb.Event.Level.ValueType) -> None:
        """An event in the log, and a line for whoever watches."""
        self._warn(text)
        self.publish(topics.SERVER_EVENT, pb.Event(level=level, name=name, text=text))

    def _items(self, samples: list[WireSample]) -> Iterator[Item]:
        for sample in samples:
            header = Header.unpack(sample.attachment)
            if header is None or header.t_ns < 0:
                self.without_header += 1
            else:
                yield Item(sample.key, header, sample.payload)
