"""The run's time: real, scaled, or told by the lockstep hub. Nothing else reads a clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

NS_PER_S = 1_000_000_000


class WallClock:
    """The run's time from a monotonic clock, `speed` times as fast, from `origin_ns` on.

    Deadlines follow the monotonic clock, so that a board whose wall clock is set late keeps its pace.
    """

    def __init__(
        self,
        origin_ns: int,
        started_ns: int,
        speed: float = 1.0,
        monotonic_ns: Callable[[], int] = time.monotonic_ns,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._origin_ns = origin_ns
        self._started_ns = started_ns
        self._speed = speed
        self._monotonic_ns = monotonic_ns
        self._sleep = sleep
        self.late_ticks = 0
        """Ticks that began more than one period late and so were left out."""

    def now_ns(self) -> int:
        """The run's time now."""
        return self._origin_ns + int((self._monotonic_ns() - self._started_ns) * self._speed)

    def ticks(self, period_s: float) -> Iterator[int]:
        """The run's time at every multiple of the period, each when it has come."""
        period_ns = round(period_s * NS_PER_S)
        due_ns = (self.now_ns() // period_ns + 1) * period_ns
        while True:
            wait_s = (due_ns - self.now_ns()) / NS_PER_S / self._speed
            if wait_s > 0:
                self._sleep(wait_s)
            due_ns += self._missed_ns(due_ns, period_ns)
            yield due_ns
            due_ns += self._missed_ns(due_ns, period_ns) + period_ns

    def _missed_ns(self, due_ns: int, period_ns: int) -> int:
        """The whole periods since a tick was due: a process that was stopped goes on from now."""
        missed = max(0, (self.now_ns() - due_ns) // period_ns)
        self.late_ticks += missed
        return missed * period_ns


def unix_clock() -> WallClock:
    """Real time on a board: the Unix time at the start, kept by the monotonic clock."""
    return WallClock(time.time_ns(), time.monotonic_ns())


def scaled_clock(started_ns: int, speed: float) -> WallClock:
    """Simulation on one machine: 0 at the monotonic time `started_ns` that all processes were given."""
    return WallClock(0, started_ns, speed)
