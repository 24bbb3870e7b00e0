"""From the names of figures to judged claims: runs what their comparisons need."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from swarm.errors import UserError
from swarm.gridworld.condition import Condition
from swarm.paper.catalogue import load_figure
from swarm.paper.claim import (
    Better,
    Check,
    ChosenMore,
    CloserPairs,
    Converged,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    Joins,
    MuchSmallerLoss,
    NoDifference,
    PortionsTested,
)
from swarm.paper.conditions import LARGE_HORIZON_STEPS
from swarm.paper.options import Settings
from swarm.paper.render import render_plot, results_folder
from swarm.paper.results import Results
from swarm.paper.runner import run_all
from swarm.paper.study import Figure, Study
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.judge import Judged, judge
from swarm.statistics.corrections import benjamini_hochberg, holm


@dataclass(frozen=True)
class Corrected:
    """A claim's own p value, and those that take all claims into account."""

    p: float
    holm: float
    benjamini_hochberg: float


@dataclass(frozen=True)
class Assessment:
    """Judged claims, and the plot of each figure that has one."""

    judged: tuple[Judged, ...]
    plots: dict[str, Path]
    folder: Path
    runs: int
    seed: int
    steps: int | None

    @property
    def corrected(self) -> tuple[Corrected | None, ...]:
        """For each claim its p value among those of all claims; None for one that no test decides."""
        tested = [place for place, judged in enumerate(self.judged) if judged.p is not None]
        p = np.array([self.judged[place].p for place in tested], dtype=np.float64)
        found: list[Corrected | None] = [None] * len(self.judged)
        for place, *numbers in zip(tested, p, holm(p), benjamini_hochberg(p), strict=True):
            found[place] = Corrected(*map(float, numbers))
        return tuple(found)


def assess(names: Iterable[str], settings: Settings, *, plots: bool = True) -> Assessment:
    """Run, plot if so asked, and judge what the text says of these figures; UserError if it says nothing."""
    asked = [load_figure(name) for name in names]
    figures = [figure for figure in asked if figure.claims]
    if not figures:
        nothing_about = ", ".join(figure.name for figure in asked)
        raise UserError(f"the text makes no claim that can be checked about {nothing_about}")
    studies = [figure for figure in figures if isinstance(figure, Study)]
    runs = max((settings.runs_of(study) for study in studies), default=1)
    store = run_all(((condition, runs) for figure in figures for condition in _needed(figure)), settings)
    results = Results(store, runs)
    judged = tuple(
        judge(figure.name, claim, Evidence(results, _horizon(figure)))
        for figure in figures
        for claim in figure.claims
    )
    drawn = {study.name: render_plot(study, results) for study in studies} if plots else {}
    return Assessment(judged, drawn, results_folder(results), runs, settings.seed, settings.steps)


def _horizon(figure: Figure) -> int:
    return figure.horizon_steps if isinstance(figure, Study) else LARGE_HORIZON_STEPS


def _needed(figure: Figure) -> Iterator[Condition]:
    if isinstance(figure, Study):
        yield from figure.series.values()
    for claim in figure.claims:
        for check in claim.checks:
            yield from _conditions(check)


def _conditions(check: Check) -> tuple[Condition, ...]:
    match check:
        case Better(one, other) | NoDifference(one, other) | FindsShortestSooner(one, other):
            return one, other
        case CloserPairs(one, other):
            return one, other
        case Joins(one, others):
            return one, *others
        case MuchSmallerLoss(one, other, baseline):
            return one, other, baseline
        case FindsShortestBy(condition) | HigherRatio(condition) | ChosenMore(condition):
            return (condition,)
        case Converged(condition) | PortionsTested(condition):
            return (condition,)
        case _:
            return ()
