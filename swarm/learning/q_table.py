"""The table of Q values and the two learning rules that change it (eq. 1 and 7)."""

from __future__ import annotations

import math

from swarm.geometry import MOVES
from swarm.learning.random import Rng
from swarm.learning.snapshot import finite

ALPHA = 0.2
GAMMA = 0.7
DISCOUNT_RATE_PER_S = 0.149


class QTable:
    """Q(s, a) for every state and each of the eight moves, 0 at the start."""

    def __init__(self, states: int) -> None:
        self.values = [[0.0] * MOVES for _ in range(states)]
        self.total = 0.0
        """The sum of all values, kept up to date: the number of values times their average."""

    def best_value(self, state: int) -> float:
        """max_a Q(s, a): what the paper prints as argmax in eq. 1 and 7."""
        return max(self.values[state])

    def best_actions(self, state: int) -> list[int]:
        """Every action whose value no other exceeds, in ascending order."""
        row = self.values[state]
        best = max(row)
        return [action for action, value in enumerate(row) if value == best]

    def greedy(self, state: int, rng: Rng) -> int:
        """argmax_a Q(s, a), ties broken at random; a single best action draws no random number.

        First-index ties break the learning: the agent would run along the arena's edge for ever.
        """
        best = self.best_actions(state)
        return best[0] if len(best) == 1 else best[int(rng.integers(len(best)))]

    def has_better(self, state: int, action: int) -> bool:
        """Whether there is an a' with Q(s, a') > Q(s, a): the check that rejects an imitated path."""
        return self.best_value(state) > self.values[state][action]

    def update(self, state: int, action: int, reward: float, next_state: int, discount: float) -> float:
        """Learn from one transition; return the change of Q(s, a) that the rule asks for.

        It may be too small for the stored value to move; whether such changes count towards n_Q+ is
        `swarm.learning.controller.QIncrease`.

        Eq. 1 with `discount` gamma and `reward` r(t+1); eq. 7 with `discount` and `reward` from
        `discount_over`. The algorithms' listings drop gamma; eq. 1 is what is meant.
        """
        target = reward + discount * self.best_value(next_state)
        change = ALPHA * (target - self.values[state][action])
        value = self.values[state][action]
        self.values[state][action] = value + change
        self.total += self.values[state][action] - value
        return change

    def snapshot(self) -> list[list[float]]:
        """The value of every action in every state."""
        return [list(row) for row in self.values]

    def restore(self, values: list[list[float]]) -> None:
        """Go on from a snapshot; ValueError if it is of another number of states."""
        if len(values) != len(self.values):
            raise ValueError(f"it has {len(values)} states; the grid has {len(self.values)}")
        if any(len(row) != MOVES for row in values):
            raise ValueError(f"a state has not {MOVES} actions")
        self.values = [[finite(value) for value in row] for row in values]
        self.total = sum(map(sum, self.values))


def discount_over(duration_s: float, rate_per_s: float = DISCOUNT_RATE_PER_S) -> float:
    """Eq. 7's exp(-beta (t2 - t1)) for a measured duration: 0.7 over a move of 2.4 s.

    The reward is an impulse on arrival, so that eq. 7's integral is this factor times the reward.
    """
    return math.exp(-rate_per_s * duration_s)
