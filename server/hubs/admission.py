"""Who takes part in a run: whom the experiment names and whose identity is the run's, and nobody else."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

from server.hubs.attendance import Tell
from swarm.logs.ending import Sender
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Item
from swarm.messages.topics import EARLIER, Role, Topic, topic_of
from swarm.runtime.identity import Fingerprint
from swarm.runtime.liveliness import Presence
from swarm.runtime.senders import EMULATOR

MOST_STARTS = 100
"""Of one name in a run: who starts more often is ill, or makes epochs up."""
MOST_SAID = 1000
"""Refusals that are told one by one; a stranger may make up new names for ever."""


class Admission:
    """Judges presences and messages: those count whose key and epoch belong to somebody who takes part.

    An epoch that was admitted stays so: what a process sent before it left arrives after it has gone.
    """

    def __init__(self, identity: Fingerprint, robots: Collection[str], tell: Tell) -> None:
        self._identity = identity
        self._robots = robots
        self._tell = tell
        self._admitted: dict[tuple[str, str], set[int]] = {}
        self._said: set[str] = set()

    def admits(self, presence: Presence) -> bool:
        """Whether somebody who is present takes part; if not, the reason is told once."""
        reason = self._reason_against(presence)
        if reason:
            who = f"{presence.kind} {presence.name!r} on host {presence.host!r}"
            self._say(f"{who} does not take part: {reason}", about=f"{who} {reason}")
        else:
            self._admitted.setdefault((presence.kind, presence.name), set()).add(presence.epoch)
        return not reason

    def admit(self, senders: Iterable[Sender]) -> None:
        """Who stands in the logs of a trial took part in it, though its process may be gone."""
        for key, epoch in senders:
            for name in _senders(*found)[:1] if (found := topic_of(key)) else ():
                self._admitted.setdefault(name, set()).add(epoch)

    def knows(self, epoch: int) -> bool:
        """Whether an epoch is of somebody who took part."""
        return any(epoch in starts for starts in self._admitted.values())

    def robots_of(self, epoch: int) -> tuple[str, ...]:
        """The robots of a process that took part, in order; none if it is of no robot."""
        found = (
            name for (kind, name), starts in self._admitted.items() if kind == "robot" and epoch in starts
        )
        return tuple(sorted(found))

    def accepts(self, item: Item) -> bool:
        """Whether a message that came from elsewhere is the run's: of whoever the key table says sends it.

        What the server says comes from nowhere else. An operator shows no presence, and hubs with
        certificates know it. Keys that the table does not know are left to the recorder, which counts them.
        """
        epoch = item.header.epoch
        found = topic_of(item.key)
        if found is None or any(epoch in self._admitted.get(name, ()) for name in _senders(*found)):
            return True
        if found[0].sender is Role.OPERATOR:
            return True
        text = f"messages of {item.key[:80]} from nobody who takes part (epoch {epoch}) are left out"
        self._say(text, about=item.key)
        return False

    def _reason_against(self, presence: Presence) -> str:
        """Why somebody does not take part; empty if they do."""
        starts = self._admitted.get((presence.kind, presence.name), set())
        if len(starts) >= MOST_STARTS and presence.epoch not in starts:
            return f"it has started {MOST_STARTS} times in this run"
        if presence.kind in ("robot", EARLIER["robot"]) and presence.name not in self._robots:
            return f"the experiment does not name it; it names {', '.join(self._robots)}"
        if presence.identity == str(self._identity):
            return ""
        try:
            return ", ".join(self._identity.differences(Fingerprint.parse(presence.identity)))
        except ValueError:
            return "it does not say of which run it is: is it of an older version?"

    def _say(self, text: str, about: str) -> None:
        """Once for everything that it is about."""
        if about not in self._said and len(self._said) < MOST_SAID:
            self._said.add(about)
            self._tell("refused", text, pb.Event.WARNING)


def _senders(topic: Topic[Any], robot: str) -> tuple[tuple[str, str], ...]:
    """Kind and name of those who send a topic, of or about a robot, to the server."""
    if topic.sender is Role.TRACKER:
        return (("tracker", "bridge"), (EARLIER["tracker"], "bridge"))
    return (("robot", robot), (EARLIER["robot"], robot), EMULATOR) if topic.sender is Role.ROBOT else ()
