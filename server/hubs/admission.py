"""Who takes part in a run: whom the experiment names and whose identity is the run's, and nobody else."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from server.hubs.attendance import Tell
from swarm.logs.ending import Sender
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Item
from swarm.messages.topics import topic_of
from swarm.runtime.identity import Fingerprint
from swarm.runtime.liveliness import Presence

SPEAKING_FOR_ALL = ("tracker", "emulator")
"""They publish what they measure of every robot under its keys."""
MOST_SAID = 1000
"""Refusals that are told one by one; a stranger may make up new epochs for ever."""


class Admission:
    """Judges presences and messages: those count whose key and epoch belong to somebody who takes part.

    An epoch that was admitted stays so: what a process sent before it left arrives after it has gone.
    """

    def __init__(self, identity: Fingerprint, robots: Collection[str], own_epoch: int, tell: Tell) -> None:
        self._identity = identity
        self._robots = robots
        self._tell = tell
        self._served_by = {own_epoch}
        self._admitted: set[tuple[str, int]] = set()
        self._said: set[str] = set()

    def admits(self, presence: Presence) -> bool:
        """Whether somebody who is present takes part; if not, the reason is told once."""
        reason = self._reason_against(presence)
        if reason:
            who = f"{presence.kind} {presence.name!r} on host {presence.host!r}"
            self._say(f"{who} does not take part: {reason}")
        elif presence.kind == "robot":
            self._admitted.add((presence.name, presence.epoch))
        elif presence.kind in SPEAKING_FOR_ALL:
            self._served_by.add(presence.epoch)
        return not reason

    def admit(self, senders: Iterable[Sender]) -> None:
        """Who stands in the logs of a trial took part in it, though its process may be gone."""
        for key, epoch in senders:
            found = topic_of(key)
            if found and found[1] and not found[0].to_robot:
                self._admitted.add((found[1], epoch))
            else:
                self._served_by.add(epoch)

    def knows(self, epoch: int) -> bool:
        """Whether an epoch is of somebody who took part."""
        return epoch in self._served_by or any(epoch == admitted for _, admitted in self._admitted)

    def accepts(self, item: Item) -> bool:
        """Whether a message is the run's: a robot speaks under its own keys; server, tracker and emulator
        under all.

        Keys that the key table does not know are left to the recorder, which counts them.
        """
        epoch = item.header.epoch
        if epoch in self._served_by:
            return True
        found = topic_of(item.key)
        if found is None or (not found[0].to_robot and (found[1], epoch) in self._admitted):
            return True
        self._say(f"messages of {item.key[:80]} from nobody who takes part (epoch {epoch}) are left out")
        return False

    def _reason_against(self, presence: Presence) -> str:
        """Why somebody does not take part; empty if they do."""
        if presence.kind == "robot" and presence.name not in self._robots:
            return f"the experiment does not name it; it names {', '.join(self._robots)}"
        if presence.identity == str(self._identity):
            return ""
        try:
            return ", ".join(self._identity.differences(Fingerprint.parse(presence.identity)))
        except ValueError:
            return "it does not say of which run it is: is it of an older version?"

    def _say(self, text: str) -> None:
        if text not in self._said and len(self._said) < MOST_SAID:
            self._said.add(text)
            self._tell("refused", text, pb.Event.WARNING)
