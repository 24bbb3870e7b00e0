"""Who of those that a live run needs is there: every robot of the experiment, and a tracker bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.liveliness import Presence
from swarm.runtime.zenoh_session import PresenceWatch

TRACKER = "the tracker bridge"

Tell = Callable[[str, str, pb.Event.Level.ValueType], None]
"""Tells of something that a person should know: an event's name, its text, its level."""


class Attendance:
    """Follows presence, and tells in one line each who has gone and who is back."""

    def __init__(self, watch: PresenceWatch, robots: Sequence[str], tell: Tell) -> None:
        self._watch = watch
        self._tell = tell
        self._present: dict[str, set[str]] = {name: set() for name in (*robots, TRACKER)}
        self._gone: set[str] = set()

    @property
    def missing(self) -> list[str]:
        """The names of those that are not there."""
        return [name for name, keys in self._present.items() if not keys]

    def look(self) -> None:
        """Take in who has come and gone since the last look."""
        for key, is_there in self._watch.poll():
            presence = _parsed(key)
            name = _name(presence) if presence else ""
            if presence and name in self._present:
                keys = self._present[name]
                (keys.add if is_there else keys.discard)(key)
                self._tell_of(name, presence.host)

    def _tell_of(self, name: str, host: str) -> None:
        if not self._present[name] and name not in self._gone:
            self._gone.add(name)
            text = f"{name} is gone: its process on host {host} ended, hangs or lost its connection"
            self._tell("gone", text, pb.Event.WARNING)
        elif self._present[name] and name in self._gone:
            self._gone.discard(name)
            self._tell("back", f"{name} is back, on host {host}", pb.Event.WARNING)


def _parsed(key: str) -> Presence | None:
    """None for a token that is not as the key table has it: a stranger's."""
    try:
        return Presence.parse(key)
    except (UserError, ValueError):
        return None


def _name(presence: Presence) -> str:
    if presence.kind == "tracker":
        return TRACKER
    return presence.name if presence.kind == "robot" else ""
