"""The progress bar of a set of runs, and how long the rest will take."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from swarm.paper.store import Timing


@contextmanager
def progress_bar(total: int, time_left: TimeLeft) -> Iterator[Callable[[Timing], None]]:
    """Yields what to call after each run."""
    if not sys.stderr.isatty():
        yield lambda timing: time_left.finished(timing.condition, timing.seconds)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("runs, {task.description}"))
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("estimating the time left", total=total)

        def finished(timing: Timing) -> None:
            time_left.finished(timing.condition, timing.seconds)
            bar.update(task, advance=1, description=in_words(time_left.seconds))

        yield finished


def in_words(seconds: float | None) -> str:
    """A duration as a person would say it, no more exact than it is known."""
    if seconds is None:
        return "estimating the time left"
    if seconds < 90:
        return f"about {seconds:.0f} s left"
    if seconds < 5400:
        return f"about {seconds / 60:.0f} min left"
    return f"about {seconds / 3600:.1f} h left"


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
