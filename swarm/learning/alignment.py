"""How far a copied list of moves is from the real one."""

from __future__ import annotations

from collections.abc import Sequence


def edit_distance(copied: Sequence[int], real: Sequence[int]) -> int:
    """The least number of moves to insert, leave out or change (Levenshtein 1966)."""
    row = list(range(len(real) + 1))
    for number, move in enumerate(copied, 1):
        before, row[0] = row[0], number
        for place, wanted in enumerate(real, 1):
            changed = before + (move != wanted)
            before, row[place] = row[place], min(changed, row[place] + 1, row[place - 1] + 1)
    return row[-1]
