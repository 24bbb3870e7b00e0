"""What a run's agents know and are, as the arrays and numbers that the kernels work on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

UNLIMITED = 2**62
"""More steps than any machine makes, and twice as many still fit a signed word."""
NO_REPLAY = -1
"""No path has this number."""
FIXED, COMPLETION, AVERAGE_Q = 0, 1, 2
"""`Approach` as the kernels know it."""
ASKED, STORED, AVERAGE = 0, 1, 2
"""`QIncrease` as the kernels know it."""
COPIED, TRIED, SUGGESTED, SUGGESTED_AT_RANDOM = 0, 1, 2, 3
"""Places in an agent's tally: paths remembered, paths replayed at least once, actions suggested by another's
table, and those of them for which that table knew nothing."""
WATCHES_NOBODY, WATCHES_EXPERT, WATCHES_OTHER = 0, 1, 2
"""Whom a learner copies, as the kernels know it."""


class ArenaArrays(NamedTuple):
    """The arena and the two ends of a run."""

    ways: NDArray[np.uint8]
    """The set of moves that lead out of each cell (states,)"""
    offsets: NDArray[np.uint64]
    """What each move adds to the number of the cell (moves,)"""
    start: np.uint64
    goal: np.uint64
    expert_path: NDArray[np.uint8]
    """(moves of the expert,)"""


class Rules(NamedTuple):
    """What does not change during a run."""

    alpha: float
    gamma: float
    explores_below: np.uint64
    """Epsilon in units of 2^-53, rounded up: an agent explores if 53 random bits are below it"""
    beta: float
    approach: int
    watches: int
    every: int
    moves: int
    accesses: bool
    """Whether a path is the other agent's policy, of `moves` moves"""
    seen: bool
    """Whether another watches, so that the agent's moves have to be kept"""
    increase: int
    """Which change of Q counts towards n_Q+"""
    checks_last: bool
    """Whether the last action of a path undergoes the Q check"""


class Limits(NamedTuple):
    """When a run ends, how often the best path is evaluated, and whether a second agent takes part."""

    steps: int
    reachings: int
    every: int
    pair: bool
    points: int
    """After so many evaluations, they come every `later_every` steps"""
    later_every: int


class AgentArrays(NamedTuple):
    """One agent: its table, its memory of paths, and the moves that others may have seen of it.

    Single numbers are arrays of one, so that the kernels can change them.
    """

    q: NDArray[np.float64]
    """(states x moves,)"""
    best: NDArray[np.float64]
    """max_a Q(s, a) (states,)"""
    greedy: NDArray[np.uint8]
    """The set of actions that have that value (states,)"""
    state: NDArray[np.uint64]
    arrivals: NDArray[np.int64]
    stream: NDArray[np.uint64]
    watching: NDArray[np.uint64]
    """The stream of what the agent happens to see."""
    paths: NDArray[np.uint8]
    """(capacity, moves)"""
    lengths: NDArray[np.int64]
    n_replicated: NDArray[np.int64]
    n_counted: NDArray[np.int64]
    """n_completed or n_Q+ (capacity,)"""
    ratios: NDArray[np.float64]
    """R_i of eq. 4 (capacity,)"""
    totals: NDArray[np.float64]
    """Their running sums (capacity,)"""
    remembered: NDArray[np.int64]
    replay: NDArray[np.int64]
    """The memory's place of the path being replayed, or NO_REPLAY"""
    replay_index: NDArray[np.int64]
    q_change: NDArray[np.float64]
    """The sum of the replay's changes of Q values that count"""
    q_total: NDArray[np.float64]
    """The sum of all Q values, kept where their average counts"""
    tally: NDArray[np.int64]
    """What has happened how often (4,)"""
    trail: NDArray[np.uint8]
    """The last moves of this run, in a ring (moves,)"""
    trail_moves: NDArray[np.int64]
    """Moves of this run so far"""
    shown: NDArray[np.uint8]
    """The last moves of the run before (moves,)"""
    shown_moves: NDArray[np.int64]


class BestPathArrays(NamedTuple):
    """The last greedy path found without a random choice, and the sets that it rests on."""

    route: NDArray[np.uint16]
    sets: NDArray[np.uint8]
    length: NDArray[np.int64]
    """0 if the last path met a tie"""
    stream: NDArray[np.uint64]
    lengths: NDArray[np.int16]
    """What was found so far (points,)"""
    counts_luck: bool
    """Whether a path through cells in which nothing has been learnt may arrive"""


class LearnerArrays(NamedTuple):
    """An agent, how it learns, and what was found of its best path."""

    agent: AgentArrays
    rules: Rules
    found: BestPathArrays
