"""What a hub hears under one key, and no more than an honest sender says there.

A process may go mad, or be somebody else's. What it sends too much is left out and told of; the others are
heard as before, and the server's memory does not grow.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from server.hubs.attendance import Tell
from swarm.access.zenoh_limits import FASTER
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Item
from swarm.messages.topics import Topic
from swarm.runtime.zenoh_session import MOST_AT_ONCE, Session, WireSample

UNRATED_PER_S = 20.0
"""Of what comes as it happens: a robot makes a move or two a second."""
AT_ONCE = 1000
"""After a gap in the radio, or at a start that tells of many paths; a robot keeps less for a server."""
TOLD_EVERY_S = 10.0


class LimitedInbox:
    """The messages of one topic from or about one robot, polled by the main loop.

    `speed` is that of the clock: a run that is twice as fast says twice as much a second.
    """

    def __init__(self, session: Session, topic: Topic[Any], robot: str, speed: float, tell: Tell) -> None:
        self.key = topic.key(robot)
        listen = session.recovering_inbox if topic.is_recovered else session.inbox_of_others
        self._most = min(MOST_AT_ONCE, topic.most_waiting)
        self._inbox = listen(self.key, self._most)
        self._at_once = min(AT_ONCE, self._most)
        self._per_s = (FASTER * topic.rate_hz if topic.rate_hz else UNRATED_PER_S) * speed
        self._allowed = float(self._at_once)
        self._tell = tell
        self._looked_s: float | None = None
        self._told_s = 0.0
        self._untold = 0
        self.left_out = 0

    def poll(self) -> list[WireSample]:
        """What has arrived since the last look, in order."""
        return self._inbox.poll(self._most)

    def limited(self, items: list[Item], now_s: float) -> list[Item]:
        """Of what is its sender's own, what is not too much; `now_s` never goes back."""
        self._allow(now_s)
        taken = items[: int(self._allowed)]
        self._allowed -= len(taken)
        self._leave_out(len(items) - len(taken), now_s)
        return taken

    def _allow(self, now_s: float) -> None:
        elapsed_s = now_s - self._looked_s if self._looked_s is not None else 0.0
        self._looked_s = now_s
        self._allowed = min(self._at_once, self._allowed + elapsed_s * self._per_s)

    def _leave_out(self, count: int, now_s: float) -> None:
        self.left_out += count
        self._untold += count
        if self._untold and (self.left_out == self._untold or now_s - self._told_s >= TOLD_EVERY_S):
            self._told_s, self._untold = now_s, 0
            text = f"{self.key} brings more than {self._per_s:g} messages a second: {self.left_out} left out"
            self._tell("flood", f"{text}; is its sender ill?", pb.Event.WARNING)


def inboxes_of(
    session: Session, topics: Iterable[Topic[Any]], robots: Iterable[str], speed: float, tell: Tell
) -> list[LimitedInbox]:
    """One for each key that a run of these robots has."""
    names = list(robots)
    return [
        LimitedInbox(session, topic, robot, speed, tell)
        for topic in topics
        for robot in (names if "{robot}" in topic.pattern else [""])
    ]
