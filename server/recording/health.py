"""The rate at which each key is seen against the rate that the key table declares."""

from __future__ import annotations

from server.hubs.hub import Batch
from server.reporter import Reporter
from swarm.clock import NS_PER_S
from swarm.messages.topics import topic_of

WINDOW_NS = 10 * NS_PER_S
"""A hundred messages of the common rate of 10 Hz: a share is then known to some percent."""
LOW_SHARE = 0.5
"""A blackout of the simulated tracker, 3 s, leaves two thirds of a window: it is no fault."""


class Health:
    """Counts messages in windows of 10 s of the run; an event tells of keys that fall behind or recover."""

    def __init__(self, reporter: Reporter) -> None:
        self._reporter = reporter
        self._counts: dict[str, int] = {}
        self._low: set[str] = set()
        self._window_began_ns: int | None = None
        self.lowest_share: dict[str, float] = {}
        """The worst window of each key, as a share of the declared rate."""

    def step(self, batch: Batch) -> None:
        """Count a batch; at the end of a window compare with the table."""
        counts = self._counts
        for item in batch.items:
            counts[item.key] = counts.get(item.key, 0) + 1
        if self._window_began_ns is None:
            self._window_began_ns = batch.t_ns
        elif batch.t_ns - self._window_began_ns >= WINDOW_NS:
            self._compare((batch.t_ns - self._window_began_ns) / NS_PER_S)
            self._window_began_ns = batch.t_ns

    def _compare(self, elapsed_s: float) -> None:
        for key, count in self._counts.items():
            found = topic_of(key)
            if found and found[0].rate_hz:
                self._judge(key, count / elapsed_s / found[0].rate_hz)
            self._counts[key] = 0

    def _judge(self, key: str, share: float) -> None:
        self.lowest_share[key] = min(share, self.lowest_share.get(key, share))
        if (share < LOW_SHARE) != (key in self._low):
            self._low ^= {key}
            name = "slow" if share < LOW_SHARE else "recovered"
            self._reporter.event(name, f"{key}: {share:.0%} of the declared rate")
