"""How often copied paths are enacted, against their R, their use and how true they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from swarm.geometry import Move
from swarm.statistics.samples import FloatArray
from swarm.surrogate.trial import EnactedPath

Memory = Sequence[EnactedPath]
"""Of one learner at the end of a trial."""
PERMUTATIONS = 2000
"""The smallest p they can show is 0.0005."""


def usefulness(moves: Sequence[Move]) -> float:
    """Cells towards the south-east corner that a move of the list brings on average: 1 for SE, -1 for NW."""
    return float(np.mean([(move.columns + move.rows) / 2 for move in moves]))


def rank_correlations(memories: Sequence[Memory], of: str) -> FloatArray:
    """Spearman's, of R and `of` ("enacted" or "usefulness"), in each memory in which both vary."""
    found = []
    for memory in memories:
        ratios = [path.ratio for path in memory]
        other = [path.enacted if of == "enacted" else usefulness(path.path.copied) for path in memory]
        if len(set(ratios)) > 1 and len(set(other)) > 1:
            found.append(stats.spearmanr(ratios, other).statistic)
    return np.array(found, dtype=np.float64)


def most_enacted(memory: Memory) -> EnactedPath:
    return max(memory, key=lambda path: path.enacted)


def least_enacted(memory: Memory) -> EnactedPath:
    return min(memory, key=lambda path: path.enacted)


@dataclass(frozen=True)
class Share:
    """What imperfect copies have of all enactments, against their share of the paths."""

    enacted: float
    expected: float
    p: float
    """Of "no more than their share", by permuting in each memory which of its paths are imperfect."""


def share_of_imperfect(memories: Sequence[Memory], rng: np.random.Generator) -> Share | None:
    """The mean over the memories that hold both kinds; None if none does."""
    mixed = [memory for memory in memories if 0 < sum(path.path.perfect for path in memory) < len(memory)]
    counted = [memory for memory in mixed if any(path.enacted for path in memory)]
    if not counted:
        return None
    seen, expected, permuted = np.zeros(len(counted)), np.zeros(len(counted)), np.zeros(PERMUTATIONS)
    for place, memory in enumerate(counted):
        enacted = np.array([path.enacted for path in memory], dtype=np.float64)
        enacted /= enacted.sum()
        imperfect = np.array([not path.path.perfect for path in memory])
        seen[place], expected[place] = enacted[imperfect].sum(), imperfect.mean()
        labels = rng.permuted(np.tile(imperfect, (PERMUTATIONS, 1)), axis=1)
        permuted += labels @ enacted / len(counted)
    at_least = np.sum(permuted >= seen.mean() - 1e-12)
    return Share(float(seen.mean()), float(expected.mean()), float((at_least + 1) / (PERMUTATIONS + 1)))
