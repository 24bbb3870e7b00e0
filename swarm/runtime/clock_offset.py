"""Another host's clock against this one, from the times that its messages say they were sent at."""

from __future__ import annotations

from collections import deque

from swarm.clock import NS_PER_S

EARLY_S = 0.25
"""A message cannot come before it was sent; clocks that are set by the network agree to some milliseconds."""
LATE_S = 0.5
"""Above what a radio link and two ticks take, below the 1 s at which a robot stands for want of a pose."""
AGREEING = 5
"""So many messages in a row prove another clock: one alone may be wrong, or have waited on its way."""
AGREE_WITHIN_S = 0.25
"""Messages that waited on a slow link come at all sorts of times."""


class ClockOffset:
    """What must be added to a sender's times to have them on this clock.

    Clocks that agree are taken as they are: the offset stays 0. It changes only once several messages in a
    row agree on another, so that no single wrong time counts. It is measured one way, from the message that
    was quickest, and thus too large by the time which that one took. `speed` scales the run's time. A clock
    that `can_step` may be set while it runs; with one that cannot, later messages have waited on their way.
    """

    def __init__(self, speed: float = 1.0, *, can_step: bool) -> None:
        self._can_step = can_step
        self._known = False
        self._early_ns = round(EARLY_S * NS_PER_S * speed)
        self._late_ns = round(LATE_S * NS_PER_S * speed)
        self._agree_ns = round(AGREE_WITHIN_S * NS_PER_S * speed)
        self._doubted_ns: deque[int] = deque(maxlen=AGREEING)
        self.ns = 0

    def heard(self, sent_ns: int, now_ns: int, usual_ns: int = 0) -> bool:
        """Take in when a message was sent, by its sender's clock; True if that has changed the offset.

        It may be as late as clocks that agree allow, and `usual_ns` more.
        """
        ahead_ns = now_ns - sent_ns
        if self._agrees(ahead_ns - self.ns, usual_ns):
            self._doubted_ns.clear()
            self._known = True
            return False
        if self._known and not self._can_step and ahead_ns > self.ns:
            return False
        if self._doubted_ns and abs(ahead_ns - self._doubted_ns[-1]) > self._agree_ns:
            self._doubted_ns.clear()
        self._doubted_ns.append(ahead_ns)
        if len(self._doubted_ns) < AGREEING:
            return False
        offset_ns = min(self._doubted_ns)
        self.ns = 0 if self._agrees(offset_ns, usual_ns) else offset_ns
        self._doubted_ns.clear()
        self._known = True
        return True

    def on_this_clock(self, theirs_ns: int, now_ns: int, usual_ns: int = 0) -> int | None:
        """A sender's time as this clock has it, or None while it is not to be believed."""
        self.heard(theirs_ns, now_ns, usual_ns)
        own_ns = theirs_ns + self.ns
        return own_ns if self._agrees(now_ns - own_ns, usual_ns) else None

    def _agrees(self, late_ns: int, usual_ns: int) -> bool:
        return -self._early_ns <= late_ns <= self._late_ns + usual_ns


def described(offset_ns: int) -> str:
    """For people: "3.0 s behind", the other clock against this one."""
    return f"{abs(offset_ns) / NS_PER_S:.1f} s {'behind' if offset_ns > 0 else 'ahead of'}"
