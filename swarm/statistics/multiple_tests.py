"""Several tests at once at a level that holds: the probability of any false finding stays below it."""

from __future__ import annotations

from collections.abc import Sequence


def holm(p_values: Sequence[float]) -> list[float]:
    """Each p value adjusted for all of them (Holm 1979, Scandinavian Journal of Statistics 6:65-70).

    The smallest of n counts n times, the next n - 1 times, and so on, and none less than the one before:
    what is at or below a level then may be called a finding, however the tests depend on each other.
    """
    adjusted, highest = [0.0] * len(p_values), 0.0
    for rank, place in enumerate(sorted(range(len(p_values)), key=lambda place: p_values[place])):
        highest = max(highest, min(1.0, (len(p_values) - rank) * p_values[place]))
        adjusted[place] = highest
    return adjusted
