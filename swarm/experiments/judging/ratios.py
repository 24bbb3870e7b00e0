"""The order of the R values (eq. 4) of an agent's paths."""

from __future__ import annotations

import numpy as np

from swarm.analysis.curves import Curves, FloatArray
from swarm.experiments.claim import HigherRatio
from swarm.experiments.judging.comparison import LEVEL, compare, effect_between
from swarm.experiments.judging.evidence import Evidence
from swarm.experiments.judging.finding import Finding, Verdict
from swarm.experiments.judging.wording import compared
from swarm.gridworld.condition import GivenPaths


def higher_ratio(check: HigherRatio, evidence: Evidence) -> Finding:
    """One path against each of the others, in one family: a "point" of the tests for each other path."""
    higher, lower = _pairs(check, evidence)
    found = compare(lower, higher, evidence.seed, in_time=False)
    beaten = round(sum(window.duration + 1 for window in found.honest.windows))
    others = len(check.lower)
    why = (
        f"R of {check.higher.name} {higher.values.mean():.3f}, of the others at most "
        f"{lower.values.mean(axis=0).max():.3f}; significantly above {beaten} of {others}"
    )
    effect = effect_between(lower, higher, 0, others)
    verdict = _verdict(beaten, others, evidence.enough_runs or found.honest.smallest_p <= LEVEL)
    return Finding(compared(check), verdict, why, found.paper, found.honest, effect, "higher")


def _verdict(beaten: int, others: int, decided: bool) -> Verdict:
    if beaten == others:
        return Verdict.HOLDS
    if not decided:
        return Verdict.UNDECIDED
    return Verdict.IN_PART if beaten else Verdict.DOES_NOT_HOLD


def _pairs(check: HigherRatio, evidence: Evidence) -> tuple[Curves, Curves]:
    assert isinstance(check.condition.teacher, GivenPaths)
    first_moves = [path.moves[0] for path in check.condition.teacher.paths]
    ratios = evidence.results.ratios(check.condition)
    lower = ratios[:, [first_moves.index(move) for move in check.lower]]
    higher = np.repeat(ratios[:, [first_moves.index(check.higher)]], len(check.lower), axis=1)
    return _curves(check.higher.name, higher), _curves("the other paths", lower)


def _curves(name: str, values: FloatArray) -> Curves:
    return Curves(name, np.arange(float(values.shape[1])), values, tuple(range(len(values))))
