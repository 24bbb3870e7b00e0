"""How far every host's clock is from the server's: measured, logged, and warned of."""

from __future__ import annotations

from collections.abc import Iterable

from server.hubs.attendance import TRACKER, Tell
from swarm.clock import NS_PER_S
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.messages.header import Item
from swarm.messages.topics import topic_of
from swarm.runtime.clock_offset import LATE_S, described

WINDOW_NS = 5 * NS_PER_S
"""Five status messages of each robot: the quickest of them shows the clock, and not its way."""


class ClockWatch:
    """Compares the times in status messages and poses with the server's, over windows of the run's time.

    A warning tells of a clock that is wrong, once, and of one that is right again. Clocks that agree are
    in the log with their first window.
    """

    def __init__(self, speed: float, tell: Tell) -> None:
        self._far_ns = round(LATE_S * NS_PER_S * speed)
        self._tell = tell
        self._quickest_ns: dict[str, int] = {}
        self._is_far: dict[str, bool] = {}
        self._due_ns: int | None = None

    def step(self, items: Iterable[Item], now_ns: int) -> None:
        """Take in what came in a batch."""
        for item in items:
            name = _sender(item.key)
            if name:
                behind_ns = now_ns - item.header.t_ns
                self._quickest_ns[name] = min(behind_ns, self._quickest_ns.get(name, behind_ns))
        if self._due_ns is None:
            self._due_ns = now_ns + WINDOW_NS
        elif now_ns >= self._due_ns:
            self._due_ns = now_ns + WINDOW_NS
            self._judge()

    def _judge(self) -> None:
        quickest_ns, self._quickest_ns = self._quickest_ns, {}
        for name, behind_ns in quickest_ns.items():
            is_far = abs(behind_ns) > self._far_ns
            if self._is_far.get(name) != is_far:
                first, self._is_far[name] = name not in self._is_far, is_far
                self._tell_of(name, behind_ns, is_far, first)

    def _tell_of(self, name: str, behind_ns: int, is_far: bool, first: bool) -> None:
        clock = f"the clock of {name} is {described(behind_ns)} the server's"
        if is_far:
            self._tell("clock", f"{clock}: let its host follow a time server", pb.Event.WARNING)
        else:
            self._tell("clock", clock, pb.Event.INFO if first else pb.Event.WARNING)


def _sender(key: str) -> str:
    """Whose clock a message shows; "" for one that comes too often to be looked at, or too seldom."""
    found = topic_of(key)
    if found is None:
        return ""
    topic, robot = found
    if topic is topics.STATUS:
        return robot
    return TRACKER if topic is topics.POSE else ""
