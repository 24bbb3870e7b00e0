"""A learner that acts in real time: algorithm 3 with eq. 7, its counters, and what came of each move.

The same for a robot, which publishes what comes of its moves, and for its surrogate, which keeps it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict

from swarm.geometry import Grid
from swarm.learning.controller import Controller, ControllerSnapshot, Outcome
from swarm.learning.greedy_path import greedy_path_length
from swarm.learning.memory import Path
from swarm.learning.q_table import discount_over
from swarm.learning.random import Rng, RngState, restore_rng, rng_state
from swarm.learning.snapshot import count

MOVES_BETWEEN_EVALUATIONS = 10
"""Section 2.1 of the paper: "every 10 time units"."""
REWARD_IN_GOAL = 1.0
"""Q values grow in proportion to it, and no choice depends on their size."""


@dataclass(frozen=True, slots=True)
class Transition:
    """What came of an action: eq. 7's s, a, s' and t2 - t1."""

    state: int
    action: int
    next_state: int
    duration_s: float
    blocked: bool


@dataclass(frozen=True, slots=True)
class ReplayRecord:
    """A replay that has ended: of which path, its moves and the first one's number, and what it came to."""

    path: int
    moves: int
    started_move: int
    outcome: Outcome
    q_change: float
    ratio: float
    """The path's R_i, this replay counted."""


@dataclass(frozen=True, slots=True)
class Choice:
    """An action, and the replay that the Q check rejected before it was chosen, if there was one."""

    action: int
    rejected: ReplayRecord | None


@dataclass(frozen=True, slots=True)
class MoveRecord:
    """What came of a move; of an expert's, nothing that is learnt."""

    number: int
    """Counted from 1."""
    track: int
    """The journey that the move belongs to, counted from 1."""
    transition: Transition
    reward: float = 0.0
    q_value: float = 0.0
    q_change: float = 0.0
    path: int = 0
    """The number of the path that was replayed; 0 for the learner's own choice."""
    ended: ReplayRecord | None = None
    """The replay that ended with this move."""
    best_path_length: int | None = None
    """The greedy path's length, after every tenth move."""


class LearnerSnapshot(TypedDict):
    """A learner, as JSON can hold it."""

    moves: int
    tracks: int
    controller: ControllerSnapshot
    evaluation_rng: RngState


class Learner:
    """A controller with a grid and counters; ask `choose`, act, then tell `learn`.

    `evaluation_rng` breaks the ties of the greedy path, so that looking at the learning does not change it.
    """

    def __init__(
        self,
        grid: Grid,
        controller: Controller,
        evaluation_rng: Rng,
        path_length_cap: int,
        discount_rate_per_s: float,
    ) -> None:
        self.controller = controller
        self.moves = 0
        self.tracks = 0
        self.path_length_cap = path_length_cap
        self._grid = grid
        self._evaluation_rng = evaluation_rng
        self._discount_rate_per_s = discount_rate_per_s

    def remember(self, path: Path) -> int:
        """Algorithm 3's AddNewPath; returns the path's number."""
        return self.controller.memory.remember(path).number

    def choose(self, state: int) -> Choice:
        """Algorithm 3's choice."""
        return Choice(self.controller.choose(state), self._ended())

    def learn(self, transition: Transition) -> MoveRecord:
        """Eq. 7: the reward is an impulse on arrival in the goal, discounted over the move."""
        arrived = transition.next_state == self._grid.goal
        reward = REWARD_IN_GOAL if arrived else 0.0
        replay = self.controller.replay
        path = replay.remembered.number if replay else 0
        track = self.tracks + 1
        change = self._update(transition, reward, arrived=arrived)
        self.moves += 1
        self.tracks += arrived
        return MoveRecord(
            number=self.moves,
            track=track,
            transition=transition,
            reward=reward,
            q_value=self.controller.q.values[transition.state][transition.action],
            q_change=change,
            path=path,
            ended=self._ended(),
            best_path_length=self._evaluated(),
        )

    @property
    def best_moves(self) -> list[list[int]]:
        """The actions with the highest Q value of every state: what section 2.4 lets another robot access."""
        return [self.controller.q.best_actions(state) for state in range(self._grid.states)]

    def abandon(self) -> None:
        """Drop a replay whose move came to nothing; its path is not counted."""
        self.controller.replay = None

    def snapshot(self) -> LearnerSnapshot:
        """Everything that it needs to go on."""
        return {
            "moves": self.moves,
            "tracks": self.tracks,
            "controller": self.controller.snapshot(),
            "evaluation_rng": rng_state(self._evaluation_rng),
        }

    def restore(self, saved: LearnerSnapshot) -> None:
        """Go on from a snapshot; ValueError if it does not fit."""
        self.controller.restore(saved["controller"])
        restore_rng(self._evaluation_rng, saved["evaluation_rng"])
        self.moves = count(saved["moves"])
        self.tracks = count(saved["tracks"], self.moves)

    def _update(self, transition: Transition, reward: float, *, arrived: bool) -> float:
        discount = discount_over(transition.duration_s, self._discount_rate_per_s)
        return self.controller.learn(
            transition.state,
            transition.action,
            discount * reward,
            transition.next_state,
            discount,
            blocked=transition.blocked,
            arrived=arrived,
        )

    def _ended(self) -> ReplayRecord | None:
        """The replay that the controller ended just now."""
        ended = self.controller.ended
        if ended is None:
            return None
        return ReplayRecord(
            path=ended.remembered.number,
            moves=ended.moves,
            started_move=self.moves - ended.moves + 1,
            outcome=ended.outcome,
            q_change=ended.q_change,
            ratio=self.controller.memory.ratio(ended.remembered),
        )

    def _evaluated(self) -> int | None:
        if self.moves % MOVES_BETWEEN_EVALUATIONS:
            return None
        return greedy_path_length(self.controller.q, self._grid, self._evaluation_rng, self.path_length_cap)
