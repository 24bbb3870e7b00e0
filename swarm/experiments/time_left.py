"""How long the rest of the runs will take, from how long runs of each condition have taken."""

from __future__ import annotations

from collections.abc import Mapping


class TimeLeft:
    """Counts runs down. Conditions differ a hundredfold, so each is estimated from its own runs.

    `costs` says how the conditions compare as long as none of their runs has ended (any unit); `counts`
    is how many runs of each are to be done.
    """

    def __init__(self, costs: Mapping[str, float], counts: Mapping[str, int], workers: int) -> None:
        self._costs = costs
        self._left = dict(counts)
        self._workers = workers
        self._seconds = dict.fromkeys(counts, 0.0)
        self._done = dict.fromkeys(counts, 0)

    def finished(self, name: str, seconds: float) -> None:
        """One run of this condition has ended and took so long."""
        self._left[name] -= 1
        self._done[name] += 1
        self._seconds[name] += seconds

    @property
    def seconds(self) -> float | None:
        """The estimate; None before the first run has ended."""
        known_cost = sum(self._costs[name] * done for name, done in self._done.items())
        if not known_cost:
            return None
        pace = sum(self._seconds.values()) / known_cost
        work = sum(left * self._run_seconds(name, pace) for name, left in self._left.items())
        return work / min(self._workers, max(1, sum(self._left.values())))

    def _run_seconds(self, name: str, pace: float) -> float:
        done = self._done[name]
        return self._seconds[name] / done if done else self._costs[name] * pace
