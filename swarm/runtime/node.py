"""How a process of the swarm takes part in a run: it subscribes, publishes, and steps at every tick."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from google.protobuf.message import Message

from swarm.clock import WallClock
from swarm.errors import RunFailedError
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header
from swarm.messages.topics import Topic
from swarm.runtime.subscription import Subscription
from swarm.runtime.zenoh_session import Inbox, Publisher, Session

M = TypeVar("M", bound=Message)

Step = Callable[[int], None]
"""What a process does at a tick, given the run's time in nanoseconds."""


class Node(Protocol):
    """The same for real time and for lockstep, so that no process knows which it is in."""

    keys_received: set[str]
    """Every key of which this process received a message."""
    run_id: str
    """The run that this process takes part in; empty in a lockstep."""

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        """A subscription of one robot's messages, or of all robots'."""

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        """Send a message under the robot's key."""

    def run(self, step: Step) -> None:
        """Step at every tick, until the run ends.

        Steps come one at a time, perhaps on another thread; once this returns or raises there are no more.
        """


class Sequencer:
    """Numbers the messages of each key from 1."""

    def __init__(self) -> None:
        self._sequences: dict[str, int] = {}

    def following(self, key: str) -> int:
        """The number of the key's next message."""
        number = self._sequences.get(key, 0) + 1
        self._sequences[key] = number
        return number


class LivePublisher:
    """Sends messages over the network, each with its sender's epoch, its number and the time."""

    def __init__(self, session: Session, clock: WallClock, epoch: int) -> None:
        self._session = session
        self._clock = clock
        self._epoch = epoch
        self._sequencer = Sequencer()
        self._publishers: dict[str, Publisher] = {}

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        """Send a message under the topic's key, of a robot if it has one."""
        key = topic.key(robot)
        header = Header(self._epoch, self._sequencer.following(key), self._clock.now_ns())
        if key not in self._publishers:
            self._publishers[key] = self._session.publisher(key, topic.delivery)
        self._publishers[key].put(message.SerializeToString(), attachment=header.pack())


class LiveNode:
    """Takes part over the network at the pace of a clock: on boards, and in simulation at a given speed."""

    def __init__(
        self, session: Session, clock: WallClock, period_s: float, epoch: int, run_id: str = ""
    ) -> None:
        self.run_id = run_id
        self._session = session
        self._clock = clock
        self._period_s = period_s
        self._live = LivePublisher(session, clock, epoch)
        self._inboxes: list[tuple[Inbox, Subscription[Any]]] = []
        self.keys_received: set[str] = set()
        self._run_states = self.subscribe(topics.RUN_STATE)

    def subscribe(self, topic: Topic[M], robot: str = "*") -> Subscription[M]:
        """A subscription filled at every tick; `*` in a key keeps every message, since it holds many keys."""
        subscription = Subscription(topic)
        inbox = self._session.inbox(topic.key(robot), topic.delivery, keep_all=robot == "*")
        self._inboxes.append((inbox, subscription))
        return subscription

    def publish(self, topic: Topic[M], message: M, robot: str = "") -> None:
        self._live.publish(topic, message, robot)

    def run(self, step: Step) -> None:
        for t_ns in self._clock.ticks(self._period_s):
            self._take_in()
            states = [state.message for state in self._run_states.take()]
            for state in states:
                self._refuse_another_run(state)
            step(t_ns)
            if any(state.phase == pb.RunState.ENDED for state in states):
                return

    def _refuse_another_run(self, state: pb.RunState) -> None:
        if self.run_id and state.run_id != self.run_id:
            raise RunFailedError(
                f"the server has begun another run ({state.run_id or 'without an id'}), and this process "
                f"takes part in run {self.run_id}: start it again to take part in the new one"
            )

    def _take_in(self) -> None:
        for inbox, subscription in self._inboxes:
            for sample in inbox.poll():
                self.keys_received.add(sample.key)
                subscription.put(sample.key, Header.unpack(sample.attachment), sample.payload)
