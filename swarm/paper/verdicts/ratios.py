"""Paths of a memory against each other: their R values, and how often they were replayed."""

from __future__ import annotations

import numpy as np

from swarm.geometry import Move
from swarm.gridworld.condition import Condition, GivenPaths
from swarm.paper.claim import ChosenMore, HigherRatio
from swarm.paper.verdicts.curve_tests import compare, effect_between
from swarm.paper.verdicts.evidence import Evidence
from swarm.paper.verdicts.finding import Finding, Verdict
from swarm.paper.verdicts.wording import compared
from swarm.statistics.paired_tests import LEVEL
from swarm.statistics.samples import Curves, FloatArray


def higher_ratio(check: HigherRatio, evidence: Evidence) -> Finding:
    """R of one path against each of the others, in one family."""
    table = evidence.results.ratios(check.condition)
    return _ranked(check, evidence, table, check.higher, check.lower, "R", "higher")


def chosen_more(check: ChosenMore, evidence: Evidence) -> Finding:
    """The replays of one path against those of each of the others, in one family."""
    table = evidence.results.of_memory(check.condition, "replicated")
    return _ranked(check, evidence, table, check.more, check.less, "replays", "replays more")


def _ranked(
    check: HigherRatio | ChosenMore,
    evidence: Evidence,
    table: FloatArray,
    first: Move,
    others: tuple[Move, ...],
    name: str,
    unit: str,
) -> Finding:
    """A "point" of the tests for each other path."""
    higher, lower = _pairs(check.condition, table, first, others)
    found = compare(lower, higher, evidence.seed, in_time=False)
    beaten = round(sum(window.duration + 1 for window in found.family_wise.windows))
    why = (
        f"{name} of {first.name} {_short(higher.values.mean())}, of the others at most "
        f"{_short(lower.values.mean(axis=0).max())}; significantly above {beaten} of {len(others)}"
    )
    decided = evidence.enough_runs or found.family_wise.smallest_p <= LEVEL
    return Finding(
        compared(check),
        _verdict(beaten, len(others), decided),
        why,
        found.paper,
        found.family_wise,
        effect_between(lower, higher, 0, len(others)),
        unit,
        float(found.p_in_favour.max()),
    )


def _short(number: float) -> str:
    return f"{number:,.0f}" if number >= 100 else f"{number:.3f}"


def _verdict(beaten: int, others: int, decided: bool) -> Verdict:
    if beaten == others:
        return Verdict.HOLDS
    if not decided:
        return Verdict.UNDECIDED
    return Verdict.IN_PART if beaten else Verdict.DOES_NOT_HOLD


def _pairs(
    condition: Condition, table: FloatArray, first: Move, others: tuple[Move, ...]
) -> tuple[Curves, Curves]:
    assert isinstance(condition.teacher, GivenPaths)
    first_moves = [path.moves[0] for path in condition.teacher.paths]
    lower = table[:, [first_moves.index(move) for move in others]]
    higher = np.repeat(table[:, [first_moves.index(first)]], len(others), axis=1)
    return _curves(first.name, higher), _curves("the other paths", lower)


def _curves(name: str, values: FloatArray) -> Curves:
    return Curves(name, np.arange(float(values.shape[1])), values, tuple(range(len(values))))
