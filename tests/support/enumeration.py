"""Exact probabilities of what a randomised function does: it is run once for every way its luck can turn."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable
from typing import TypeVar, cast

Result = TypeVar("Result", bound=Hashable)


class Uniform:
    """A number of [0, scale) that is known only as far as comparisons have asked."""

    def __init__(self, luck: EnumeratedRng, scale: float = 1.0) -> None:
        self.luck, self.scale = luck, scale
        self.low, self.high = 0.0, scale

    def __mul__(self, factor: float) -> Uniform:
        return Uniform(self.luck, self.scale * factor)

    def __lt__(self, bound: float) -> bool:
        if bound <= self.low or bound >= self.high:
            return bound >= self.high
        below = (bound - self.low) / (self.high - self.low)
        if self.luck.turn([below, 1.0 - below]) == 0:
            self.high = bound
            return True
        self.low = bound
        return False


class EnumeratedRng:
    """An `Rng` whose first turns are given and that notes the turns it could have taken instead."""

    def __init__(self, script: tuple[int, ...]) -> None:
        self.script, self.taken = script, 0
        self.probability = 1.0
        self.untried: list[tuple[int, ...]] = []

    def turn(self, probabilities: list[float]) -> int:
        """Which of the alternatives comes true."""
        if self.taken < len(self.script):
            chosen = self.script[self.taken]
        else:
            chosen = 0
            self.untried += [(*self.script, other) for other in range(1, len(probabilities))]
            self.script = (*self.script, 0)
        self.taken += 1
        self.probability *= probabilities[chosen]
        return chosen

    def random(self) -> float:
        return cast(float, Uniform(self))

    def integers(self, high: int, /) -> int:
        return self.turn([1.0 / high] * high)


def probabilities(play: Callable[[EnumeratedRng], Result]) -> dict[Result, float]:
    """The probability of each result of `play`, which must start afresh with every generator it gets."""
    found: defaultdict[Result, float] = defaultdict(float)
    scripts: list[tuple[int, ...]] = [()]
    while scripts:
        rng = EnumeratedRng(scripts.pop())
        found[play(rng)] += rng.probability
        scripts += rng.untried
    return dict(found)
