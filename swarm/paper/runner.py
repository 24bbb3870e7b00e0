"""From the names of figures to their runs, tables and plots; what is done is not run again."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from swarm.errors import UserError
from swarm.gridworld.condition import Condition
from swarm.paper.options import Settings, check_sizes
from swarm.paper.progress import TimeLeft, progress_bar
from swarm.paper.render import render
from swarm.paper.store import RunStore, Timing, open_store
from swarm.paper.study import Figure, Study
from swarm.parallel import Workers, workers

if TYPE_CHECKING:
    from swarm.gridworld.simulation import Trace


Task = tuple[Condition, int]
Finished = Callable[[Timing], None]


def run_once(condition: Condition, seed: int, run: int) -> tuple[Condition, int, Trace, float]:
    """One run with the seconds it took, as a worker does it."""
    from swarm.gridworld.simulation import simulate

    started_s = time.perf_counter()
    trace = simulate(condition, seed, run)
    return condition, run, trace, time.perf_counter() - started_s


def runs_of_each(wanted: Iterable[tuple[Condition, int]]) -> dict[Condition, int]:
    """Each condition once, with the most runs that any figure asks of it; UserError if two share a name."""
    by_name: dict[str, Condition] = {}
    runs_of: dict[Condition, int] = {}
    for condition, runs in wanted:
        if by_name.setdefault(condition.name, condition) != condition:
            raise UserError(f"two different conditions are named {condition.name!r}; rename one of them")
        runs_of[condition] = max(runs, runs_of.get(condition, 0))
    return runs_of


def missing_tasks(store: RunStore, runs_of: Mapping[Condition, int]) -> list[Task]:
    """What is not on the disk yet: run 0 of every condition first, so that all can be estimated early."""
    return [
        (condition, run)
        for run in range(max(runs_of.values(), default=0))
        for condition, runs in runs_of.items()
        if run < runs and not store.has(condition, run)
    ]


def run_tasks(store: RunStore, tasks: Sequence[Task], workers: Workers, finished: Finished) -> None:
    """Compute tasks and save each as it comes in. The numbers depend on the seed and the run alone."""
    calls = [(store.condition(condition), store.seed, run) for condition, run in tasks]
    for condition, run, trace, seconds in workers.each(run_once, calls):
        store.save(condition, run, trace)
        timing = Timing(condition.name, run, round(seconds, 6), trace.steps * condition.learners)
        store.add_timing(timing)
        finished(timing)


def expected_costs(conditions: Iterable[Condition]) -> dict[str, float]:
    """The steps that a run of each condition may take, to compare them before any has run."""
    return {condition.name: float(_expected_steps(condition)) for condition in conditions}


def count_by_condition(tasks: Iterable[Task]) -> dict[str, int]:
    """How many runs of each condition are to be done."""
    return Counter(condition.name for condition, _ in tasks)


def _expected_steps(condition: Condition) -> int:
    side = max(condition.arena.grid.columns, condition.arena.grid.rows)
    by_goals = 2 * side * (condition.goal_reachings or 0)
    limits = [limit for limit in (condition.steps, by_goals) if limit]
    return condition.learners * min(limits)


STEPS_WORTH_A_PROCESS = 60_000_000
"""Fewer are simulated before another process has started."""


def run_all(wanted: Iterable[tuple[Condition, int]], settings: Settings) -> RunStore:
    """Run what the directory does not hold yet: so many runs of each condition.

    Workers come first: a directory is made only if somebody is there to fill it.
    """
    runs_of = runs_of_each(wanted)
    place, readings = (settings.root, settings.seed, settings.steps), settings.readings
    store = RunStore(*place, readings)
    check_sizes(store, runs_of, settings.jobs)
    tasks = missing_tasks(store, runs_of)
    if not tasks:
        return open_store(*place, runs_of, readings)
    as_run = [(store.condition(condition), run) for condition, run in tasks]
    costs = expected_costs(condition for condition, _ in as_run)
    with workers(settings.scheduler, min(settings.jobs, _useful_jobs(as_run, costs))) as started:
        store = open_store(*place, runs_of, readings)
        time_left = TimeLeft(costs, count_by_condition(as_run), started.count)
        with progress_bar(len(tasks), time_left) as finished:
            run_tasks(store, tasks, started, finished)
    return store


def _useful_jobs(tasks: Sequence[Task], costs: Mapping[str, float]) -> int:
    steps = sum(costs[condition.name] for condition, _ in tasks)
    return min(len(tasks), 1 + int(steps / STEPS_WORTH_A_PROCESS))


def reproduce(figures: Iterable[Figure], settings: Settings) -> dict[str, dict[str, Any]]:
    """Run, tabulate and plot figures; figure -> its curves, R values, files and times."""
    chosen = list(figures)
    studies = [figure for figure in chosen if isinstance(figure, Study)]
    store = run_all(
        ((condition, settings.runs_of(study)) for study in studies for condition in study.series.values()),
        settings,
    )
    return {figure.name: render(figure, store, settings) for figure in chosen}
