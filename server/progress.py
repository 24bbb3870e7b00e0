"""What a person sees of a run: a bar while it goes on, and a summary at its end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from server.conductor.conductor import Conductor
from server.run_directory import trial_name
from swarm.config.experiment import Experiment

LINE_EVERY_S = 30.0
"""Real seconds: often enough that a person, or who reads a file of it, sees that the run goes on."""


class RunProgress:
    """A progress bar on a terminal; elsewhere a line every 30 s."""

    def __init__(
        self, experiment: Experiment, console: Console, monotonic_s: Callable[[], float] = time.monotonic
    ) -> None:
        self._experiment = experiment
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=10),
            TextColumn("{task.completed:.0f}/{task.total:.0f} {task.fields[what]}"),
            TextColumn("{task.fields[learning]}"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self._monotonic_s = monotonic_s
        self._line_due_s = monotonic_s() + LINE_EVERY_S
        self._trial = ""
        self._task = self._progress.add_task("", total=experiment.run.moves, learning="", what="moves")

    def __enter__(self) -> RunProgress:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def begin(self, trial: int) -> None:
        """A new trial, called as its log is: the bar starts again."""
        of = f" of {self._experiment.run.trials}" if self._experiment.run.trials > 1 else ""
        self._trial = f"{trial_name(trial)}{of}"
        self._progress.reset(self._task, description=self._trial, learning="", what="moves")

    def played(self, trial: int, count: int) -> None:
        """Of several trials at a time one has ended: the bar counts trials."""
        of = self._experiment.run.trials
        self._progress.update(self._task, description="", what="trials", completed=count, total=of)
        if self._progress.disable:
            self._progress.console.print(f"{trial_name(trial)}: played, {count} of {of}", highlight=False)

    def show(self, conductor: Conductor, elapsed_s: float) -> None:
        """Moves of the slowest learner, the trial's time, and the best path of each condition."""
        made = min(conductor.moves[robot.id] for robot in self._experiment.learners)
        learning = f"{span(elapsed_s)}, path: {', '.join(self._best_paths(conductor)) or 'none yet'}"
        self._progress.update(self._task, completed=made, learning=learning)
        if self._progress.disable and self._monotonic_s() >= self._line_due_s:
            self._line_due_s = self._monotonic_s() + LINE_EVERY_S
            of = self._experiment.run.moves
            self._progress.console.print(f"{self._trial}: {made}/{of} moves, {learning}", highlight=False)

    def _best_paths(self, conductor: Conductor) -> Iterator[str]:
        """The mean over a condition's learners; 0, before the first evaluation, is left out."""
        lengths: dict[str, list[int]] = {}
        for robot in self._experiment.learners:
            if length := conductor.best_path[robot.id]:
                lengths.setdefault(robot.group, []).append(length)
        for condition, values in lengths.items():
            yield f"{condition} {sum(values) / len(values):.0f}"

    def warn(self, text: str) -> None:
        """A line above the bar."""
        self._progress.console.print(f"warning: {text}", highlight=False)


def print_summary(summary: Mapping[str, Any]) -> None:
    """Where the run is, how long it took, and what to do next."""
    print(f"run        {summary['run']}")
    robots_time, own_time = span(summary["sim_s"]), span(summary["wall_s"])
    print(f"moves      {summary['moves']}, {robots_time} of the robots' time in {own_time}")
    print(f"speed      {times(summary['real_time_factor'])} times real time")
    print(f"digest     {summary['digest'][:16]}")
    print(f"next       swarm analyze {summary['run']}")


def span(seconds: float) -> str:
    """A time in the unit in which it says something."""
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 3600 else f"{seconds / 3600:.1f} h"


def times(factor: float) -> str:
    """Whole, and with two digits where that says nothing: a laboratory is as fast as life, or slower."""
    return f"{factor:.0f}" if factor >= 10 else f"{factor:.2g}"
