"""What was found out about one comparison of a claim."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from swarm.statistics.effect_size import EffectSize
from swarm.statistics.paired_tests import Window


class Verdict(Enum):
    """What the runs say about a claim."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    DOES_NOT_HOLD = "does not hold"
    UNDECIDED = "cannot be decided with this many runs"


@dataclass(frozen=True)
class Tested:
    """One test of a comparison: where it is significant in the claim's favour and against it.

    `smallest_p` is the smallest p value of all points; of the family-wise test, that of the whole comparison.
    """

    name: str
    smallest_p: float
    windows: tuple[Window, ...] = ()
    against: tuple[Window, ...] = ()
    in_time: bool = True
    """Whether the windows are times; else the test was of one number a run, or of several paths."""

    @property
    def favours(self) -> bool:
        return bool(self.windows)

    @property
    def opposes(self) -> bool:
        return bool(self.against)


@dataclass(frozen=True)
class Finding:
    """A comparison in words, the paper's test, the family-wise test, the effect, and what follows."""

    compared: str
    verdict: Verdict
    why: str
    paper_test: Tested | None = None
    family_wise_test: Tested | None = None
    effect: EffectSize | None = None
    effect_unit: str = ""
    p: float | None = None
    """Of the test that decides; None where none is made."""
    arrivals: str = ""
    """When the best paths first arrive, and when they are shortest."""


def combined(verdicts: list[Verdict]) -> Verdict:
    """The verdict on a claim that needs all its comparisons to hold."""
    distinct = set(verdicts)
    if len(distinct) == 1:
        return distinct.pop()
    if distinct == {Verdict.HOLDS, Verdict.UNDECIDED}:
        return Verdict.UNDECIDED
    return Verdict.IN_PART
