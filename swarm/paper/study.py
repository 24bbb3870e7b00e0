"""A study as data plus a score: which conditions, how often, how long, and what is plotted."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from swarm.errors import UserError
from swarm.geometry import Grid, Move
from swarm.gridworld.condition import Condition

if TYPE_CHECKING:
    from swarm.statistics.samples import Curves

    Score = Callable[["Curves", float], Mapping[str, float | None]]


def learning_score(curves: Curves, shortest_moves: float) -> dict[str, float | None]:
    """The mean best path length over the time shown, and when the shortest path was first found.

    Times are in steps: the Kaplan-Meier median (None if fewer than half of the runs found it) and the mean
    up to the end of the curve, in which a run that has not found it counts as the end.
    """
    from swarm.statistics.samples import mean_level
    from swarm.statistics.survival import median_time, restricted_mean_time, times_to_threshold

    arrivals = times_to_threshold(curves, shortest_moves)
    horizon = float(curves.times[-1])
    return {
        "mean_best_path_length": float(mean_level(curves).values.mean()),
        "median_steps_to_shortest": median_time(arrivals),
        "restricted_mean_steps_to_shortest": restricted_mean_time(arrivals, horizon).time,
        "share_of_runs_that_found_it": float(arrivals.observed.mean()),
    }


_NAME = re.compile(r"[a-z][a-z0-9_-]{0,31}")


class Shown(Enum):
    """What a study's plot shows."""

    CURVES = "curves"
    RATIOS = "ratios"


@dataclass(frozen=True)
class Study:
    """One figure of learning agents.

    `series` maps the legend's labels to the conditions. The best path length is shown up to
    `horizon_steps`, over time in units of `time_unit_steps`, as the mean of `runs` runs with 95 %
    intervals at every `interval_points`-th evaluated point. `score` sums a curve up in a few numbers, given
    the length of the arena's shortest path.
    """

    name: str
    title: str
    series: Mapping[str, Condition]
    horizon_steps: int
    runs: int = 100
    time_unit_steps: int = 1
    interval_points: int = 1
    shown: Shown = Shown.CURVES
    score: Score = field(default=learning_score, repr=False)

    def __post_init__(self) -> None:
        if not self.series:
            raise UserError(f"study {self.name!r} has no series")
        for name in (self.name, *(condition.name for condition in self.series.values())):
            check_name(name)


@dataclass(frozen=True)
class Drawing:
    """A figure that shows an arena and paths in it, each from its own cell (column, row); nothing is run."""

    name: str
    title: str
    grid: Grid
    paths: Mapping[str, tuple[tuple[int, int], tuple[Move, ...]]] = field(default_factory=dict)
    marks_ends: bool = True


Figure = Study | Drawing


def check_name(name: str) -> None:
    """Names of studies and conditions become names of files; UserError unless they are plain."""
    if not _NAME.fullmatch(name):
        raise UserError(
            f"{name!r} cannot name a study or a condition: "
            "use up to 32 of a-z, 0-9, _ and -, with a letter first"
        )
