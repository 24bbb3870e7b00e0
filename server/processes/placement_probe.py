"""Finds out while a lockstep runs whether it is faster kept to its cores or left to the system.

On a quiet machine processes that keep to a core and interrupt nobody are twice as fast
(`cpu_affinity.py`). Beside others that want the cores they wait for these at every message, and are up to
thirty times as slow; then the system's own way is better. Nobody can say beforehand which it will be, so
both are tried: the other placement for a moment now and then, and the better one for the rest.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from server.processes.cpu_affinity import Placement


@dataclass(frozen=True)
class ProbeTimes:
    """How long a placement is tried, and how long the better one then stays."""

    trial_s: float = 0.1
    """Ten to a thousand exchanges, and ten time slices of the system's scheduler (3 to 10 ms)."""
    first_term_s: float = 1.0
    """The first comparison comes early: a run may last only seconds."""
    longest_term_s: float = 8.0
    """With trials of 0.1 s at half the speed, under 1 % of a quiet machine's speed goes into trials."""


WORTH_A_CHANGE = 1.15
"""Rates of two trials on an idle machine differ by about a tenth; a smaller gain is not worth a change."""
COLLAPSED = 0.5
"""A rate below half of what this placement had before: somebody else wants the cores, so look at once."""


class PlacementProbe:
    """Told of every exchange; calls `place` to change the placement."""

    def __init__(
        self,
        place: Callable[[Placement], None],
        times: ProbeTimes | None = None,
        monotonic_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self.placement = Placement.KEPT
        """The one that holds now, or is being tried."""
        self._place = place
        self._times = times or ProbeTimes()
        self._monotonic_s = monotonic_s
        self._trying = False
        self._term_s = self._times.first_term_s
        self._rates: dict[Placement, float] = {}
        self._exchanges = 0
        self._began_s = self._term_began_s = monotonic_s()

    def exchanged(self) -> None:
        """One more exchange is over."""
        self._exchanges += 1
        now_s = self._monotonic_s()
        if now_s - self._began_s >= self._times.trial_s:
            self._judge(self._exchanges / (now_s - self._began_s), now_s)

    def _judge(self, rate: float, now_s: float) -> None:
        """A stretch as long as a trial is over: note its rate and decide what the next one is."""
        collapsed = rate < COLLAPSED * self._rates.get(self.placement, 0.0)
        self._rates[self.placement] = rate
        if self._trying:
            self._end_trial(now_s)
        elif collapsed or now_s - self._term_began_s >= self._term_s:
            self._trying = True
            self._change()
        self._exchanges, self._began_s = 0, self._monotonic_s()

    def _end_trial(self, now_s: float) -> None:
        """Stay with the other placement if it is clearly faster; else the next trial comes later."""
        self._trying = False
        self._term_began_s = now_s
        if self._rates[self.placement] > WORTH_A_CHANGE * self._rates[self.placement.other]:
            self._term_s = self._times.first_term_s
        else:
            self._term_s = min(2 * self._term_s, self._times.longest_term_s)
            self._change()

    def _change(self) -> None:
        self.placement = self.placement.other
        self._place(self.placement)
