"""Who of those that a live run needs is there: every robot of the experiment, and a tracker bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from swarm.messages import swarm_pb2 as pb
from swarm.runtime.liveliness import Presence, parsed
from swarm.runtime.zenoh_session import PresenceWatch

TRACKER = "the tracker bridge"
TAKING_PART = ("robot", "tracker", "emulator")
"""The kinds of those whose messages are the run's."""

Tell = Callable[[str, str, pb.Event.Level.ValueType], None]
"""Tells of something that a person should know: an event's name, its text, its level."""


class Attendance:
    """Follows presence, and tells in one line each who has gone and who is back.

    Who is not admitted is not there.
    """

    def __init__(
        self, watch: PresenceWatch, robots: Sequence[str], admits: Callable[[Presence], bool], tell: Tell
    ) -> None:
        self._watch = watch
        self._admits = admits
        self._tell = tell
        self._dismissed = False
        self._present: dict[str, set[str]] = {name: set() for name in (*robots, TRACKER)}
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
        if presence.kind not in TAKING_PART or not self._admits(presence):
            return
        name = _name(presence)
        self._present.get(name, set()).add(key)
        if name in self._gone and not self._dismissed:
            self._gone.discard(name)
            self._tell("back", f"{name} is back, on host {presence.host}", pb.Event.WARNING)

    def _go(self, key: str, presence: Presence) -> None:
        name = _name(presence)
        if key not in self._present.get(name, ()):
            return
        self._present[name].discard(key)
        if not self._present[name] and not self._dismissed:
            self._gone.add(name)
            text = f"{name} is gone: its process on host {presence.host} ended, hangs or lost its connection"
            self._tell("gone", text, pb.Event.WARNING)


def _name(presence: Presence) -> str:
    """As `missing` has it; "" for one that a run can do without."""
    if presence.kind == "tracker":
        return TRACKER
    return presence.name if presence.kind == "robot" else ""
