"""The memory of observed paths: how often each is imitated, and which is forgotten (eq. 2-6)."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate

from swarm.learning.paths import Path
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


class ImitationMemory:
    """Up to `capacity` observed paths and the rule that chooses among them.

    `beta` regulates the initial imitation probability; it has to stay below 1 for appendix A's proof.
    """

    def __init__(self, beta: float, approach: Approach = Approach.AVERAGE_Q, capacity: int = 10) -> None:
        self.beta = beta
        self.approach = approach
        self.capacity = capacity
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
        remembered = RememberedPath(path)
        self.remembered.append(remembered)
        return remembered

    @property
    def full(self) -> bool:
        return len(self.remembered) >= self.capacity
