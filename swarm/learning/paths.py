"""What can be imitated: an observed list of moves or, in section 2.4 only, another agent's policy."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from swarm.geometry import Move
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng


class Path(Protocol):
    """A sequence of actions that a controller can replay."""

    def __len__(self) -> int: ...

    def action(self, index: int, state: int, rng: Rng) -> int:
        """The action at a place of the path (0 is the first) for an agent that stands in `state`."""


@dataclass(frozen=True)
class ObservedPath:
    """The moves that an agent saw another execute; in what states, it does not know."""

    moves: tuple[Move, ...]

    def __len__(self) -> int:
        return len(self.moves)

    def action(self, index: int, state: int, rng: Rng) -> int:  # noqa: ARG002
        return int(self.moves[index])

    def __str__(self) -> str:
        return "-".join(move.name for move in self.moves)

    @classmethod
    def parse(cls, names: Iterable[str]) -> ObservedPath:
        """A path from compass names such as ["SE", "SE", "E"]; ValueError names what is wrong."""
        moves = tuple(names)
        unknown = [name for name in moves if name not in Move.__members__]
        if unknown or not moves:
            known = ", ".join(Move.__members__)
            raise ValueError(f"a path is a list of moves out of {known}; got {unknown or 'none'}")
        return cls(tuple(Move[name] for name in moves))


@dataclass(frozen=True)
class AccessedPolicy:
    """Section 2.4: the other agent's greedy action in the observer's own state, for up to `length` moves.

    "Based on the previous mechanism": to the memory it is a path like any other, whose one R regulates
    how often it is started.
    """

    other: QTable
    length: int = 20

    def __len__(self) -> int:
        return self.length

    def action(self, index: int, state: int, rng: Rng) -> int:  # noqa: ARG002
        return self.other.greedy(state, rng)
