"""Many trials of an experiment file with fast robots: curves, tables and the picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from swarm.analysis.learning_curves import curve_table
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from swarm.learning.learner import MOVES_BETWEEN_EVALUATIONS
from swarm.parallel import workers
from swarm.statistics.intervals import interval
from swarm.statistics.samples import Curves, Scale, average_of_learners
from swarm.surrogate.copies import CopyStore, load_copies
from swarm.surrogate.durations import Durations, load_durations
from swarm.surrogate.trial import CopiedPath, RobotTrial, TrialOutcome
from swarm.table_files import write_table

PAPER_TRIALS = 4
"""Of figures 25 and 26."""
THRESHOLD = 12.0
"""Moves: a third above the shortest path of the paper's arena, 9."""
SHOWN_AT = (500, 1000, 1500, 2000, 3000, 4000, 6000, 8000, 10_000, 12_000, 15_000)
"""Moves: closer where curves fall, up to the end of the robots' experiments."""


@dataclass(frozen=True)
class ManyTrials:
    """What so many trials came to."""

    experiment: Experiment
    outcomes: tuple[TrialOutcome, ...]
    curves: dict[str, Curves]
    """Condition -> best path length against moves, a row a trial."""
    learnt: dict[str, Curves]
    """The same, where a path that passes a cell in which nothing has been learnt has not arrived."""


def run_trials(
    experiment: Experiment,
    copies: Path,
    durations: Path,
    trials: int,
    jobs: int,
    show: Callable[[], object] = lambda: None,
    scheduler: str = "processes",
) -> ManyTrials:
    """Trials 0 to `trials` - 1, each with its own seed; the same wherever they run."""
    if experiment.run.moves < MOVES_BETWEEN_EVALUATIONS:
        raise UserError(
            f"{experiment.run.moves} moves give no curve: the best path is noted every "
            f"{MOVES_BETWEEN_EVALUATIONS} moves"
        )
    stored = load_copies(copies), load_durations(durations)
    outcomes: list[TrialOutcome] = []
    with workers(scheduler, jobs) as pool:
        for outcome in pool.each(one_trial, ((experiment, *stored, trial) for trial in range(trials))):
            outcomes.append(outcome)
            show()
    ordered = tuple(sorted(outcomes, key=lambda outcome: outcome.trial))
    learnt = [replace(outcome, best_paths=outcome.learnt_paths) for outcome in ordered]
    curves = (condition_curves(experiment, outcomes) for outcomes in (ordered, learnt))
    return ManyTrials(experiment, ordered, *curves)


def one_trial(experiment: Experiment, copies: CopyStore, durations: Durations, trial: int) -> TrialOutcome:
    return RobotTrial(experiment, durations, copies, trial).run()


def condition_curves(experiment: Experiment, outcomes: Sequence[TrialOutcome]) -> dict[str, Curves]:
    """Learners of one condition in one trial enter as their average: they may influence each other."""
    points = experiment.run.moves // MOVES_BETWEEN_EVALUATIONS
    times = MOVES_BETWEEN_EVALUATIONS * np.arange(1, points + 1, dtype=np.float64)
    replicates = tuple((experiment.run.seed, outcome.trial) for outcome in outcomes)
    arena = experiment.arena
    scale = Scale(max(arena.columns, arena.rows) - 1.0, float(experiment.learning.path_length_cap))
    curves = {}
    for condition in dict.fromkeys(robot.group for robot in experiment.learners):
        names = [robot.id for robot in experiment.learners if robot.group == condition]
        rows = [
            average_of_learners(np.array([outcome.best_paths[name][:points] for name in names]))
            for outcome in outcomes
        ]
        curves[condition] = Curves(condition, times, np.array(rows), replicates, scale)
    return curves


def summary(many: ManyTrials) -> dict[str, Any]:
    """Mean and 95 % interval of each condition at some moves, and from where on its mean stays low.

    `mean_learnt` is without the paths that arrive by luck, through cells in which nothing has been learnt.
    """
    found = {name: _condition_summary(curves) for name, curves in many.curves.items()}
    for name, curves in many.learnt.items():
        found[name]["mean_learnt"] = _condition_summary(curves)["mean_and_interval"]
    return found | {
        "copies": _copies_summary([copied for outcome in many.outcomes for copied in outcome.copies])
    }


def _condition_summary(curves: Curves) -> dict[str, Any]:
    mean, band = curves.values.mean(axis=0), interval(curves)
    at = {}
    for move in (move for move in SHOWN_AT if move in curves.times):
        point = int(np.flatnonzero(curves.times == move)[0])
        ends = [None, None] if band is None else [float(band.low[point]), float(band.high[point])]
        at[str(move)] = [round(float(mean[point]), 2), *(end and round(end, 2) for end in ends)]
    return {"trials": len(curves.values), "mean_and_interval": at, "stays_low_from": _stays_low(curves)}


def _stays_low(curves: Curves) -> float | None:
    """The first move from which the mean stays at or below 12; None if it does not in the end."""
    above = np.flatnonzero(curves.values.mean(axis=0) > THRESHOLD)
    if not len(above):
        return float(curves.times[0])
    return float(curves.times[above[-1] + 1]) if above[-1] + 1 < len(curves.times) else None


def _copies_summary(copies: Sequence[CopiedPath]) -> dict[str, Any]:
    wrong = sum(copied.true != copied.copied for copied in copies)
    return {"remembered": len(copies), "wrong": round(wrong / len(copies), 4) if copies else None}


def write_tables(many: ManyTrials, directory: Path) -> dict[str, str]:
    """`curves.csv`: a row for each condition and point; `trials.csv`: a column for each trial."""
    tables = {
        "curves": curve_table(many.curves).with_columns(pl.col("mean", "low", "high").round(4)),
        "trials": pl.concat(_trial_columns(curves) for curves in many.curves.values()),
    }
    return {name: str(write_table(table, directory / f"{name}.csv")) for name, table in tables.items()}


def _trial_columns(curves: Curves) -> pl.DataFrame:
    place = {"condition": [curves.name] * len(curves.times), "move": curves.times.astype(np.int64)}
    return pl.DataFrame(place | {f"trial_{trial}": row for trial, row in enumerate(curves.values)})
