"""The run's time of what other clocks timed: the machine's own, and a tracking system's."""

from __future__ import annotations

import time
from collections.abc import Callable

from swarm.clock import NS_PER_S

WINDOW_NS = 10 * NS_PER_S
"""Two clocks of 100 ppm drift apart by 1 ms in this time."""
RESET_NS = NS_PER_S // 5
"""A clock that is off by so much was set, or its server started again; no network is so late."""


class LeastDelay:
    """How far two clocks are apart, from differences that are too large by varying delays.

    Nothing comes early, so the least difference of the last seconds is the nearest to the clocks' own.
    """

    def __init__(self) -> None:
        self._least: list[int] = []
        self._began_ns = 0

    def of(self, difference_ns: int, now_ns: int) -> int:
        """The least difference so far, this one included."""
        if not self._least or abs(difference_ns - min(self._least)) > RESET_NS:
            self._least, self._began_ns = [difference_ns, difference_ns], now_ns
        elif now_ns - self._began_ns > WINDOW_NS:
            self._least, self._began_ns = [self._least[1], difference_ns], now_ns
        self._least[1] = min(self._least[1], difference_ns)
        return min(self._least)


class ReceiptClock:
    """From the machine's monotonic time, at which something was received, to the run's.

    The run's time is a monotonic clock too; what is not known is how late each tick begins. The least
    lateness so far is the nearest to none.
    """

    def __init__(self, monotonic_ns: Callable[[], int] = time.monotonic_ns) -> None:
        self._monotonic_ns = monotonic_ns
        self._apart_ns: int | None = None

    def shift_ns(self, t_ns: int) -> int:
        """What to add to a monotonic time; `t_ns` is when the current tick was due, a little before now."""
        apart_ns = self._monotonic_ns() - t_ns
        self._apart_ns = apart_ns if self._apart_ns is None else min(self._apart_ns, apart_ns)
        return -self._apart_ns


class SourceClock:
    """From the tracking system's clock to the run's. Times of capture then have the source's even pace."""

    def __init__(self) -> None:
        self._delay = LeastDelay()
        self._last_ns = -1

    def captured_ns(self, source_ns: int, sent_ns: int, received_ns: int) -> int:
        """The run's time of a source time; later than the last one, never later than its receipt."""
        captured_ns = min(received_ns, source_ns + self._delay.of(received_ns - sent_ns, received_ns))
        if captured_ns <= self._last_ns <= received_ns:
            captured_ns = self._last_ns + 1
        self._last_ns = captured_ns
        return captured_ns
