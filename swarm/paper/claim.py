"""Claims as data: the paper's words, and the comparisons that would show whether they hold.

Times are in steps. "Better" is a shorter best path.
"""

from __future__ import annotations

from dataclasses import dataclass

from swarm.geometry import Move
from swarm.gridworld.arena import Arena
from swarm.gridworld.condition import Condition


@dataclass(frozen=True)
class Better:
    """`better` has significantly shorter best paths than `worse`.

    With `start_step` or `end_step`, the paper names when this begins or ends; a time counts as reproduced
    if it lies within `around_steps` of the one named. Without them, it is said of the whole curve.
    """

    better: Condition
    worse: Condition
    start_step: int | None = None
    end_step: int | None = None
    around_steps: int = 0


@dataclass(frozen=True)
class NoDifference:
    """No significant difference between the two anywhere on the curve."""

    first: Condition
    second: Condition


@dataclass(frozen=True)
class FindsShortestSooner:
    """`sooner` finds the shortest path earlier than `later`."""

    sooner: Condition
    later: Condition


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
class ShortestPathMoves:
    """Every shortest path of the arena consists of so many moves in each direction."""

    arena: Arena
    moves: tuple[tuple[Move, int], ...]


Check = Better | NoDifference | FindsShortestSooner | FindsShortestBy | HigherRatio | ShortestPathMoves


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper about one figure, in its exact words, and what has to be so for it to hold."""

    figure: str
    text: str
    checks: tuple[Check, ...]
