"""The one place that says whether an experiment can start on this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import entry_points
from pathlib import Path

from swarm.checkup.finding import Finding, warning
from swarm.checkup.machine import machine_findings
from swarm.config.experiment import Experiment

GROUP = "swarm.checks"
"""Entry points of every installed package that knows something about experiments: functions that take an
`Experiment` and give findings. The robots' process checks drivers and cameras, the tracker's its backend."""

Checks = Callable[[Experiment], Iterable[Finding]]


def findings(experiment: Experiment, out: Path | None) -> list[Finding]:
    """Everything that can be said before a simulation of the experiment starts, the good too."""
    return [*experiment_findings(experiment), *machine_findings(experiment, out)]


def experiment_findings(experiment: Experiment) -> Iterator[Finding]:
    """What the processes of this package and of others have to say about the experiment and its files."""
    found = sorted(entry_points(group=GROUP), key=lambda entry: entry.name)
    if not found:
        text = "drivers, tracker and cameras cannot be checked"
        yield warning("installation", text, f"install this package again: the group {GROUP} is empty")
    for entry in found:
        checks: Checks = entry.load()
        yield from checks(experiment)
