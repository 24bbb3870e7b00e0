"""Who is there: one presence token for each robot, tracker and server, and no two under one name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass

from swarm.errors import UserError
from swarm.messages.topics import ALIVE
from swarm.runtime.zenoh_session import PresenceWatch, Session

ALIVE_SERVER = "alive/server/*/*/*/*"
ALIVE_ROBOTS_AND_TRACKERS = "alive/*/*/*/*/*"


NO_IDENTITY = "-"
"""Of a tool that takes part in no run."""


@dataclass(frozen=True)
class Presence:
    """A process that shows that it is alive: kind is robot, tracker or server."""

    kind: str
    name: str
    host: str
    epoch: int
    identity: str = NO_IDENTITY
    """The fingerprint of the trial that it would play."""

    @property
    def key(self) -> str:
        host = re.sub(r"[^A-Za-z0-9_.-]", "-", self.host)
        return ALIVE.format(
            kind=self.kind, name=self.name, host=host, epoch=self.epoch, identity=self.identity
        )

    @classmethod
    def parse(cls, key: str) -> Presence:
        """The presence that a token's key tells of; ValueError if it is no such key."""
        _, kind, name, host, epoch, identity = key.split("/")
        return cls(kind, name, host, int(epoch), identity)


def parsed(keys: Iterable[str]) -> list[Presence]:
    """The presences that keys tell of; tokens of another shape tell nothing."""
    found = []
    for key in keys:
        with suppress(ValueError):
            found.append(Presence.parse(key))
    return found


def present(session: Session, kind: str, name: str = "*") -> list[Presence]:
    """Everyone of a kind, or with a name, who is alive now."""
    return parsed(session.alive(ALIVE.format(kind=kind, name=name, host="*", epoch="*", identity="*")))


def claim(session: Session, presence: Presence) -> None:
    """Take a name, or UserError with both hosts if another process has it.

    Of two that claim at the same moment, the one with the earlier epoch stays.
    """
    _refuse_if_taken(presence, present(session, presence.kind, presence.name))
    session.declare_alive(presence.key)
    others = [other for other in present(session, presence.kind, presence.name) if other != presence]
    _refuse_if_taken(presence, [other for other in others if other.epoch <= presence.epoch])


class ServerWatch:
    """Says in one line each when the server that a process works with is lost, and when it is back."""

    def __init__(self, watch: PresenceWatch, say: Callable[[str], None]) -> None:
        self._watch = watch
        self._say = say
        self._present: set[str] = set()
        self._lost = False
        self.losses = 0
        """How often it was lost: messages may be missing since."""

    def look(self) -> None:
        """Take in who has come and gone."""
        for key, is_there in self._watch.poll():
            (self._present.add if is_there else self._present.discard)(key)
            if self._lost == bool(self._present):
                self._lost = not self._present
                self.losses += self._lost
                self._say("lost the server: waiting for it" if self._lost else "resumed: the server is back")


def _refuse_if_taken(presence: Presence, others: list[Presence]) -> None:
    for other in others:
        raise UserError(
            f"{presence.kind} {presence.name!r} is already alive on host {other.host!r}; this one on host "
            f"{presence.host!r} does not start{_same_host(presence, other)}: stop the other, "
            "or give this one an id of its own"
        )


def _same_host(presence: Presence, other: Presence) -> str:
    return " (started twice there, or a copied card?)" if presence.host == other.host else ""
