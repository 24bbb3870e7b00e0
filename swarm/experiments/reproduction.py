"""From the names of figures to their runs, tables and plots."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from swarm.experiments.executors import workers
from swarm.experiments.limits import check_sizes
from swarm.experiments.progress import progress_bar
from swarm.experiments.render import render
from swarm.experiments.runner import (
    Task,
    count_by_condition,
    expected_costs,
    missing_tasks,
    run_tasks,
    runs_of_each,
)
from swarm.experiments.settings import Settings
from swarm.experiments.store import RunStore, open_store
from swarm.experiments.study import Figure, Study
from swarm.experiments.time_left import TimeLeft
from swarm.gridworld.condition import Condition

STEPS_WORTH_A_PROCESS = 60_000_000
"""Fewer are simulated before another process has started."""


def run_all(wanted: Iterable[tuple[Condition, int]], settings: Settings) -> RunStore:
    """Run what the directory does not hold yet: so many runs of each condition."""
    runs_of = runs_of_each(wanted)
    check_sizes(RunStore(settings.root, settings.seed, settings.steps), runs_of, settings.jobs)
    store = open_store(settings.root, settings.seed, settings.steps)
    tasks = missing_tasks(store, runs_of)
    if tasks:
        _run_missing(store, tasks, settings)
    return store


def _run_missing(store: RunStore, tasks: list[Task], settings: Settings) -> None:
    costs = expected_costs(store.condition(condition) for condition, _ in tasks)
    steps = sum(costs[condition.name] for condition, _ in tasks)
    useful_jobs = min(len(tasks), 1 + int(steps / STEPS_WORTH_A_PROCESS))
    with workers(settings.scheduler, min(settings.jobs, useful_jobs)) as started:
        time_left = TimeLeft(costs, count_by_condition(tasks), started.count)
        with progress_bar(len(tasks), time_left) as finished:
            run_tasks(store, tasks, started, finished)


def reproduce(figures: Iterable[Figure], settings: Settings) -> dict[str, dict[str, Any]]:
    """Run, tabulate and plot figures; figure -> its curves, R values, files and times."""
    chosen = list(figures)
    studies = [figure for figure in chosen if isinstance(figure, Study)]
    store = run_all(
        ((condition, settings.runs_of(study)) for study in studies for condition in study.series.values()),
        settings,
    )
    return {figure.name: render(figure, store, settings) for figure in chosen}
