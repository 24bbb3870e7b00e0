"""Which senders a process believes: a message counts if whoever may send it shows presence with its epoch.

An epoch is a number that anybody can make up. Presence is shown under a sender's own key, which a hub with
certificates grants to that sender alone; and without certificates no second one can take a name whose first
is there.
"""

from __future__ import annotations

from collections import deque
from typing import Any

from swarm.messages.topics import Role, Topic
from swarm.runtime.liveliness import Presence, parsed
from swarm.runtime.zenoh_session import Session

KNOWN_STARTS = 8
"""Of one sender: what was on its way when it ended is still believed, and more have none on the way."""
EMULATOR = ("emulator", "robots")
"""Speaks for all the robots whose bodies it plays."""
_SHOWN_AS = {Role.SERVER: ("server", "server"), Role.TRACKER: ("tracker", "bridge")}
_KINDS = {Role.SERVER: ("server",), Role.TRACKER: ("tracker",), Role.ROBOT: ("robot", "emulator")}


class BelievedSenders:
    """Follows the presence of those who send what a process hears.

    Of two who show presence under one name the one who was there first counts until it has gone.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._watches: dict[str, Any] = {}
        self._there: dict[tuple[str, str], list[Presence]] = {}
        self._starts: dict[tuple[str, str], deque[int]] = {}

    def follow(self, topic: Topic[Any]) -> None:
        """Begin to follow those who may send a topic."""
        for kind in _KINDS.get(topic.sender, ()):
            if kind not in self._watches:
                self._watches[kind] = self._session.presence_watch(f"alive/{kind}/*/*/*/*")

    def look(self) -> None:
        """Take in who has come and gone."""
        for watch in self._watches.values():
            for key, is_there in watch.poll():
                for presence in parsed([key]):
                    self._take_in(presence, is_there)

    def believes(self, topic: Topic[Any], robot: str, epoch: int) -> bool:
        """Whether a message of a topic, about or of a robot, comes from who may send it.

        An operator shows no presence: who may stop a swarm need not be there before.
        """
        if topic.sender is Role.OPERATOR:
            return True
        senders = [_SHOWN_AS[topic.sender]] if topic.sender in _SHOWN_AS else [("robot", robot), EMULATOR]
        return any(epoch in self._starts.get(sender, ()) for sender in senders)

    def _take_in(self, presence: Presence, is_there: bool) -> None:
        name = (presence.kind, presence.name)
        there = self._there.setdefault(name, [])
        if is_there and presence not in there:
            there.append(presence)
        elif not is_there and presence in there:
            there.remove(presence)
        if not there:
            del self._there[name]
        elif there[0].epoch not in self._starts.setdefault(name, deque(maxlen=KNOWN_STARTS)):
            self._starts[name].append(there[0].epoch)
