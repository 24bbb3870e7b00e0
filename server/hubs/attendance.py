"""Who of those that a live run needs is there: every robot of the experiment, and a tracker bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from swarm.messages import swarm_pb2 as pb
from swarm.messages.topics import EARLIER
from swarm.runtime.liveliness import Presence, parsed
from swarm.runtime.zenoh_session import PresenceWatch

TRACKER = "the tracker bridge"
TAKING_PART = ("robot", "tracker", "emulator")
"""The kinds of those whose messages are the run's."""

Tell = Callable[[str, str, pb.Event.Level.ValueType], None]
"""Tells of something that a person should know: an event's name, its text, its level."""


MOST_UNDER_ONE_NAME = 20
"""Who show presence under one name and wait for their turn; more are not even told of."""


class Attendance:
    """Follows presence, and tells in one line each who has gone and who is back.

    Who is not admitted is not there, nor is a second one under a name whose first is there: a card that was
    copied, or somebody who would speak in another's place.
    """

    def __init__(
        self, watch: PresenceWatch, robots: Sequence[str], admits: Callable[[Presence], bool], tell: Tell
    ) -> None:
        self._watch = watch
        self._admits = admits
        self._tell = tell
        self._dismissed = False
        self._present: dict[str, dict[str, Presence]] = {name: {} for name in (*robots, TRACKER)}
        """By name and key, in the order of their coming: the first is there, the others wait."""
        self._gone: set[str] = set()

    @property
    def missing(self) -> list[str]:
        """The names of those that are not there."""
        return [name for name, keys in self._present.items() if not keys]

    def look(self) -> None:
        """Take in who has come and gone since the last look."""
        for key, is_there in self._watch.poll():
            for presence in parsed([key]):
                if is_there:
                    self._come(key, presence)
                else:
                    self._go(key, presence)

    def dismiss(self) -> None:
        """At the end everyone leaves, which is nothing to tell of."""
        self._dismissed = True

    def _come(self, key: str, presence: Presence) -> None:
        if presence.kind in EARLIER.values():
            self._admits(presence)
        if presence.kind not in TAKING_PART:
            return
        name = _name(presence)
        there = self._present.get(name, {})
        if there and key not in there:
            self._wait(name, key, presence)
        elif self._admits(presence):
            there[key] = presence
            self._greet(name, presence)

    def _wait(self, name: str, key: str, presence: Presence) -> None:
        there = self._present[name]
        if len(there) >= MOST_UNDER_ONE_NAME:
            return
        first, *others = there.values()
        there[key] = presence
        if presence.host not in {other.host for other in others}:
            text = f"{name} is there already, on host {first.host}: one on host {presence.host} is left out"
            self._tell("duplicate", text, pb.Event.WARNING)

    def _greet(self, name: str, presence: Presence) -> None:
        if name in self._gone and not self._dismissed:
            self._gone.discard(name)
            self._tell("back", f"{name} is back, on host {presence.host}", pb.Event.WARNING)

    def _go(self, key: str, presence: Presence) -> None:
        name = _name(presence)
        there = self._present.get(name, {})
        was_there = key == next(iter(there), None)
        there.pop(key, None)
        if not was_there:
            return
        if not self._dismissed:
            self._gone.add(name)
            text = f"{name} is gone: its process on host {presence.host} ended, hangs or lost its connection"
            self._tell("gone", text, pb.Event.WARNING)
        waiting = list(there.items())
        there.clear()
        for other_key, other in waiting:
            self._come(other_key, other)


def _name(presence: Presence) -> str:
    """As `missing` has it; "" for one that a run can do without."""
    if presence.kind == "tracker":
        return TRACKER
    return presence.name if presence.kind == "robot" else ""
