"""A sender that says too much loses its own messages, is named, and keeps nobody else's out."""

from __future__ import annotations

from collections.abc import Callable

from server.hubs.limited_inbox import AT_ONCE, TOLD_EVERY_S, UNRATED_PER_S, LimitedInbox
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Header, Item
from swarm.messages.topics import ROOM_BYTES, SHORT_BYTES, Delivery
from swarm.runtime.zenoh_session import MOST_AT_ONCE, Session, SessionSettings
from tests.support.endpoints import free_endpoint


class Heard:
    """A hub's inbox of one robot's moves, a robot, and what was told."""

    def __init__(self, hub: Session, robot: Session) -> None:
        self.told: list[str] = []
        self.inbox = LimitedInbox(hub, topics.MOVE, "r0", 1.0, self._tell)
        self._put = robot.publisher("robot/r0/move", Delivery.EVERY).put
        self._all = hub.inbox("robot/r0/move", Delivery.EVERY)

    def say(self, count: int) -> None:
        """Send so many messages and wait until they have come."""
        for number in range(count):
            self._put(str(number).encode())
        came = 0
        while came < count:
            came += len(self._all.poll())

    def taken(self, now_s: float) -> list[Item]:
        """What comes through at a time."""
        samples = self.inbox.poll()
        return self.inbox.limited([Item(one.key, Header(1, 1, 0), one.payload) for one in samples], now_s)

    def _tell(self, name: str, text: str, level: pb.Event.Level.ValueType) -> None:
        assert level == pb.Event.WARNING
        self.told.append(f"{name}: {text}")


def with_heard(test: Callable[[Heard], None]) -> None:
    endpoint = free_endpoint()
    with Session(SessionSettings(endpoint, hub=True)) as hub, Session(SessionSettings(endpoint)) as robot:
        heard = Heard(hub, robot)
        heard.say(1)
        assert len(heard.taken(0.0)) == 1
        test(heard)


def test_what_is_too_much_is_left_out_and_told_of_now_and_then() -> None:
    def test(heard: Heard) -> None:
        heard.say(3000)
        assert len(heard.taken(0.0)) == AT_ONCE - 1
        heard.say(100)
        assert len(heard.taken(1.0)) == UNRATED_PER_S, "a second later there is room for a second's"
        assert len(heard.told) == 1
        assert heard.told[0].startswith(
            "flood: robot/r0/move brings more than 20 messages a second: 2001 left"
        )
        heard.say(1)
        heard.taken(1.0)
        assert len(heard.told) == 1, "not every time"
        heard.say(500)
        heard.taken(TOLD_EVERY_S)
        assert len(heard.told) == 2
        assert heard.inbox.left_out == 2001 + 80 + 1 + 500 - (TOLD_EVERY_S - 1.0) * UNRATED_PER_S

    with_heard(test)


def test_what_waits_is_bounded_and_nobody_waits_for_it() -> None:
    room = min(MOST_AT_ONCE, ROOM_BYTES // SHORT_BYTES)

    def test(heard: Heard) -> None:
        heard.say(3 * room)
        first = heard.taken(1000.0)
        assert first[0].payload == str(2 * room).encode(), "the newest are kept"

    with_heard(test)
