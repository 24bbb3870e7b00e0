"""What a person sees of a run: a bar while it goes on, and a summary at its end."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from server.conductor.conductor import Conductor
from swarm.config.experiment import Experiment


class RunProgress:
    """A progress bar on a terminal; silent where there is none."""

    def __init__(self, experiment: Experiment, console: Console) -> None:
        self._experiment = experiment
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=10),
            TextColumn("{task.completed:.0f}/{task.total:.0f}"),
            TextColumn("{task.fields[learning]}"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        learners = len(experiment.learners)
        self._task = self._progress.add_task("", total=experiment.run.moves * learners, learning="")

    def __enter__(self) -> RunProgress:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def begin(self, trial: int) -> None:
        """A new trial: the bar starts again."""
        of = f"/{self._experiment.run.trials}" if self._experiment.run.trials > 1 else ""
        self._progress.reset(self._task, description=f"trial {trial + 1}{of}", learning="")

    def show(self, conductor: Conductor, t_s: float) -> None:
        """Moves of all learners, the hours of their time, and the best path of each condition."""
        made = sum(conductor.moves[robot.id] for robot in self._experiment.learners)
        learning = f"{t_s / 3600:.1f} h, path: {', '.join(self._best_paths(conductor))}"
        self._progress.update(self._task, completed=made, learning=learning)

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
    hours = summary["sim_s"] / 3600
    print(f"run        {summary['run']}")
    print(f"moves      {summary['moves']}, {hours:.1f} h of the robots' time in {summary['wall_s']:.0f} s")
    print(f"speed      {summary['real_time_factor']:.0f} times real time")
    print(f"digest     {summary['digest'][:16]}")
    print(f"next       swarm analyze {summary['run']}")
