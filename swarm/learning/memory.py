"""What can be imitated, and the memory of it: which path is tried, which is forgotten (eq. 2-6)."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate
from typing import Protocol, TypedDict

from swarm.geometry import Move
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng


class Approach(Enum):
    """Section 2.2's three ways to set the starting probability p_imitate."""

    FIXED = "fixed"
    COMPLETION = "completion"
    AVERAGE_Q = "average_q"


@dataclass
class RememberedPath:
    """A path with the counts of its replays."""

    path: Path
    n_replicated: int = 0
    n_completed: int = 0
    n_q_plus: int = 0
    number: int = 0
    """Counted from 1 in the order in which paths were remembered; no other path ever gets it."""


class PathSnapshot(TypedDict):
    """A remembered list of moves, as JSON can hold it."""

    moves: list[str]
    n_replicated: int
    n_completed: int
    n_q_plus: int
    number: int


class MemorySnapshot(TypedDict):
    """An imitation memory, as JSON can hold it."""

    observed: int
    paths: list[PathSnapshot]


class ImitationMemory:
    """Up to `capacity` observed paths and the rule that chooses among them.

    `beta` regulates the initial imitation probability; it has to stay below 1 for appendix A's proof.
    """

    def __init__(self, beta: float, approach: Approach = Approach.AVERAGE_Q, capacity: int = 10) -> None:
        self.beta = beta
        self.approach = approach
        self.capacity = capacity
        self.observed = 0
        """Paths that were ever remembered."""
        self.remembered: list[RememberedPath] = []

    def ratio(self, remembered: RememberedPath) -> float:
        """R_i of eq. 4 (eq. 3's fraction), eq. 2's fraction, or 1 for a fixed p_imitate."""
        if self.approach is Approach.FIXED:
            return 1.0
        counted = remembered.n_completed if self.approach is Approach.COMPLETION else remembered.n_q_plus
        return (counted + 1) / (remembered.n_replicated + 1)

    def p_imitate(self, remembered: RememberedPath) -> float:
        """Eq. 2, 3 and 6: the probability of starting a path once it is chosen."""
        return self.beta * self.ratio(remembered)

    def choose(self, rng: Rng) -> RememberedPath:
        """A path drawn with P_choose (eq. 5); a single path draws no random number."""
        if len(self.remembered) == 1:
            return self.remembered[0]
        totals = list(accumulate(self.ratio(remembered) for remembered in self.remembered))
        chosen = bisect_right(totals, rng.random() * totals[-1])
        return self.remembered[min(chosen, len(totals) - 1)]

    def remember(self, path: Path) -> RememberedPath:
        """Store a path; a full memory forgets the one with the lowest ratio, the oldest of equals."""
        if len(self.remembered) >= self.capacity:
            self.remembered.remove(min(self.remembered, key=self.ratio))
        self.observed += 1
        remembered = RememberedPath(path, number=self.observed)
        self.remembered.append(remembered)
        return remembered

    @property
    def full(self) -> bool:
        return len(self.remembered) >= self.capacity

    def numbered(self, number: int) -> RememberedPath:
        """The path of this number; ValueError if it is not in the memory."""
        for remembered in self.remembered:
            if remembered.number == number:
                return remembered
        raise ValueError(f"path {number} is not in the memory")

    def snapshot(self) -> MemorySnapshot:
        """Of a memory of lists of moves."""
        return {"observed": self.observed, "paths": [_path_snapshot(each) for each in self.remembered]}

    def restore(self, saved: MemorySnapshot) -> None:
        self.observed = saved["observed"]
        self.remembered = [
            RememberedPath(
                ObservedPath.parse(path["moves"]),
                path["n_replicated"],
                path["n_completed"],
                path["n_q_plus"],
                path["number"],
            )
            for path in saved["paths"]
        ]


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


def choose_window(moves: tuple[Move, ...], count: int, rng: Rng) -> tuple[Move, ...]:
    """`count` consecutive moves at a random place of a longer track; all of a shorter one."""
    first = int(rng.integers(max(len(moves) - count, 0) + 1))
    return moves[first : first + count]


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


def _path_snapshot(remembered: RememberedPath) -> PathSnapshot:
    if not isinstance(remembered.path, ObservedPath):
        raise TypeError("only a list of moves can be saved, not the access to another's policy")
    return {
        "moves": [move.name for move in remembered.path.moves],
        "n_replicated": remembered.n_replicated,
        "n_completed": remembered.n_completed,
        "n_q_plus": remembered.n_q_plus,
        "number": remembered.number,
    }
