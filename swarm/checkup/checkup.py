"""The one place that says whether an experiment can start on this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from swarm.checkup.finding import Finding
from swarm.checkup.machine import machine_findings
from swarm.config.experiment import Experiment
from swarm.plugins import CHECKS, plugins

Checks = Callable[[Experiment], Iterable[Finding]]


def findings(experiment: Experiment, out: Path | None) -> list[Finding]:
    """Everything that can be said before a simulation of the experiment starts, the good too."""
    return [*experiment_findings(experiment), *machine_findings(experiment, out)]


def experiment_findings(experiment: Experiment) -> Iterator[Finding]:
    """What the processes of this package and of others have to say about the experiment and its files."""
    for _, entry in sorted(plugins(CHECKS).items()):
        checks: Checks = entry.load()
        yield from checks(experiment)
