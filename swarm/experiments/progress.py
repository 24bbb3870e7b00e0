"""The progress bar of a set of runs, on a terminal only; it writes to stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from swarm.experiments.time_left import TimeLeft

if TYPE_CHECKING:
    from collections.abc import Callable

    from swarm.experiments.store import Timing


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
