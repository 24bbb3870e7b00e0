"""How far a copied list of moves is from the real one, and which move stands for which (Levenshtein 1966)."""

from __future__ import annotations

from collections.abc import Sequence


def edit_distance(copied: Sequence[int], real: Sequence[int]) -> int:
    """The least number of moves to insert, leave out or change."""
    return _costs(real, copied)[-1][-1]


def aligned(real: Sequence[int], copied: Sequence[int]) -> list[list[int]]:
    """For each real move the copied ones that stand for it, with the least number of edits.

    One for a move that was copied or changed, none for one that was left out; an added move stands with
    the one before it, and at the beginning with the first.
    """
    cost = _costs(real, copied)
    stand: list[list[int]] = [[] for _ in real]
    i, j = len(real), len(copied)
    while i or j:
        if i and j and cost[i][j] == cost[i - 1][j - 1] + (real[i - 1] != copied[j - 1]):
            i, j = i - 1, j - 1
            stand[i].insert(0, copied[j])
        elif j and cost[i][j] == cost[i][j - 1] + 1:
            j -= 1
            stand[max(i - 1, 0)].insert(0, copied[j])
        else:
            i -= 1
    return stand


def _costs(real: Sequence[int], copied: Sequence[int]) -> list[list[int]]:
    """The edit distance between every beginning of the one and every beginning of the other."""
    cost = [[i + j for j in range(len(copied) + 1)] for i in range(len(real) + 1)]
    for i in range(1, len(real) + 1):
        for j in range(1, len(copied) + 1):
            changed = cost[i - 1][j - 1] + (real[i - 1] != copied[j - 1])
            cost[i][j] = min(changed, cost[i - 1][j] + 1, cost[i][j - 1] + 1)
    return cost
