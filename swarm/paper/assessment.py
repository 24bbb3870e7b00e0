"""From the names of figures to judged claims: runs what their comparisons need."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from swarm.errors import UserError
from swarm.gridworld.condition import Condition
from swarm.paper.catalogue import load_claims, load_figure
from swarm.paper.claim import (
    Better,
    Check,
    Claim,
    FindsShortestBy,
    FindsShortestSooner,
    HigherRatio,
    NoDifference,
)
from swarm.paper.conditions import LARGE_HORIZON_STEPS
from swarm.paper.options import Settings
from swarm.paper.render import render_plot
from swarm.paper.results import Results
from swarm.paper.runner import run_all
from swarm.paper.study import Figure, Study
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.judge import Judged, judge


@dataclass(frozen=True)
class Assessment:
    """Judged claims, and the plot of each figure that has one."""

    judged: tuple[Judged, ...]
    plots: dict[str, Path]
    folder: Path
    runs: int
    seed: int
    steps: int | None


def assess(names: Iterable[str], settings: Settings) -> Assessment:
    """Run, plot and judge all that the text says of these figures; UserError if it says nothing."""
    figures = {figure.name: figure for figure in map(load_figure, names)}
    claims = [claim for claim in load_claims(names) if claim.figure in figures]
    if not claims:
        raise UserError(f"the text makes no claim that can be checked about {', '.join(figures)}")
    studies = [figures[name] for name in dict.fromkeys(claim.figure for claim in claims)]
    runs = max((settings.runs_of(study) for study in studies if isinstance(study, Study)), default=1)
    store = run_all(((condition, runs) for condition in _needed(claims, studies)), settings)
    results = Results(store, runs)
    judged = tuple(judge(claim, Evidence(results, _horizon(figures[claim.figure]))) for claim in claims)
    plots = {study.name: render_plot(study, results) for study in studies if isinstance(study, Study)}
    return Assessment(judged, plots, store.root / f"{runs}-runs", runs, settings.seed, settings.steps)


def _horizon(figure: Figure) -> int:
    return figure.horizon_steps if isinstance(figure, Study) else LARGE_HORIZON_STEPS


def _needed(claims: Iterable[Claim], studies: Iterable[Figure]) -> Iterator[Condition]:
    for study in studies:
        if isinstance(study, Study):
            yield from study.series.values()
    for claim in claims:
        for check in claim.checks:
            yield from _conditions(check)


def _conditions(check: Check) -> tuple[Condition, ...]:
    match check:
        case Better(one, other) | NoDifference(one, other) | FindsShortestSooner(one, other):
            return one, other
        case FindsShortestBy(condition) | HigherRatio(condition):
            return (condition,)
        case _:
            return ()
