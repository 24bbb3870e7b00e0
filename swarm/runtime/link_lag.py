"""How far behind the world a process is: the age of the newest thing that it has heard.

A link that loses packets delivers late and in order. So a process that has heard nothing sent within the last
moments cannot have heard an emergency stop of that time either, and has to act as if there were one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from swarm.clock import NS_PER_S

DRIFT = 1e-4
"""Two quartz clocks differ by at most 100 parts in a million. More delay is the link's, and stays so."""


@dataclass
class _Sender:
    newest_ns: int
    """When the newest message was sent, by the sender's clock."""
    least_ns: int
    """What the clocks differ by, and the quickest way here."""
    since_ns: int
    """When that was so; clocks drift."""

    def usual_ns(self, now_ns: int) -> int:
        return self.least_ns + round(DRIFT * (now_ns - self.since_ns))


class LinkLag:
    """Follows the times at which messages say they were sent, by each sender's own clock.

    Clocks need not agree: what counts is how much longer the newest message has been away than the quickest.
    `speed` is how many times as fast as life the run's time passes.
    """

    def __init__(self, speed: float = 1.0) -> None:
        self._speed = speed
        self._senders: dict[int, _Sender] = {}

    def heard(self, epoch: int, sent_ns: int, now_ns: int) -> None:
        """A message has come, from the sender that began at `epoch`."""
        ahead_ns = now_ns - sent_ns
        sender = self._senders.setdefault(epoch, _Sender(sent_ns, ahead_ns, now_ns))
        sender.newest_ns = max(sender.newest_ns, sent_ns)
        if ahead_ns < sender.usual_ns(now_ns):
            sender.least_ns, sender.since_ns = ahead_ns, now_ns

    def seconds(self, now_ns: int) -> float:
        """Real seconds since the newest message was sent, beyond its usual way; infinity before the first."""
        lags_ns = [now_ns - sender.newest_ns - sender.usual_ns(now_ns) for sender in self._senders.values()]
        return min(lags_ns, default=math.inf) / NS_PER_S / self._speed
