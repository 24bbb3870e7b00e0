"""Claims as data: the paper's words, and the comparisons that would show whether they hold.

Times are in steps. "Better" is a shorter best path; sizes are in moves of the best path.
"""

from __future__ import annotations

from dataclasses import dataclass

from swarm.geometry import Move
from swarm.gridworld.arena import Arena, shortest_path
from swarm.gridworld.condition import Condition

ROUNDED_STEPS = 500_000
"""The text's times are multiples of it."""
MUCH = 0.5
""""Much smaller" and "much earlier" mean at most half."""


def visible(arena: Arena) -> float:
    """1 % of a figure's axis, which ends at the cap: what can be seen, and what is more than "very small"."""
    return arena.longest_path / 100


def negligible(arena: Arena) -> float:
    """1 % of the shortest path: the margin of "no difference"."""
    return shortest_path(arena) / 100


@dataclass(frozen=True)
class Better:
    """`better` has shorter best paths than `worse`.

    With `start_step` or `end_step`, the paper names when this begins or ends: another experiment of as many
    runs might have seen that time, rounded to `rounded_steps`. Without times it is said of the mean over the
    curve, or over the `whole_run` up to the last reaching of the goal. `at_most_moves` is how small the paper
    calls the difference.
    """

    better: Condition
    worse: Condition
    start_step: int | None = None
    end_step: int | None = None
    at_most_moves: float | None = None
    rounded_steps: int = ROUNDED_STEPS
    whole_run: bool = False


@dataclass(frozen=True)
class NoDifference:
    """The means of the two over the curve, or the whole run, differ by no more than `margin_moves`."""

    first: Condition
    second: Condition
    margin_moves: float
    whole_run: bool = False


@dataclass(frozen=True)
class Joins:
    """`one` differs at first; after `step` it is the same as all `others`, but for what is negligible."""

    one: Condition
    others: tuple[Condition, ...]
    step: int
    rounded_steps: int = ROUNDED_STEPS


@dataclass(frozen=True)
class MuchSmallerLoss:
    """What `condition` loses against `baseline` is at most half of what `than` loses, over the whole run."""

    condition: Condition
    than: Condition
    baseline: Condition


@dataclass(frozen=True)
class FindsShortestSooner:
    """`sooner` finds the shortest path earlier than `later`: in at most `part` of its time."""

    sooner: Condition
    later: Condition
    part: float = 1.0


@dataclass(frozen=True)
class FindsShortestBy:
    """Half of the runs of `condition` have found the shortest path by `step`."""

    condition: Condition
    step: int


@dataclass(frozen=True)
class HigherRatio:
    """The R value (eq. 4) of the path that begins with `higher` exceeds those that begin with `lower`."""

    condition: Condition
    higher: Move
    lower: tuple[Move, ...]


@dataclass(frozen=True)
class ChosenMore:
    """The path that begins with `more` is replayed more often than those that begin with `less`."""

    condition: Condition
    more: Move
    less: tuple[Move, ...]


@dataclass(frozen=True)
class CloserPairs:
    """The two learners of a run of `condition` are closer to each other than those of `than`."""

    condition: Condition
    than: Condition


@dataclass(frozen=True)
class Converged:
    """At the end of every run no Q value is further than `tolerance` from its final one."""

    condition: Condition
    tolerance: float


@dataclass(frozen=True)
class PortionsTested:
    """About so many copied paths are tested in a run: half to twice as many are replayed."""

    condition: Condition
    portions: int


@dataclass(frozen=True)
class ShortestPathMoves:
    """Every shortest path of the arena consists of so many moves in each direction."""

    arena: Arena
    moves: tuple[tuple[Move, int], ...]


Check = (
    Better
    | NoDifference
    | Joins
    | MuchSmallerLoss
    | FindsShortestSooner
    | FindsShortestBy
    | HigherRatio
    | ChosenMore
    | CloserPairs
    | Converged
    | PortionsTested
    | ShortestPathMoves
)


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper about a figure, in its exact words, and what has to be so for it to hold."""

    text: str
    checks: tuple[Check, ...]
