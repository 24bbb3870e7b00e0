"""The controller of algorithms 1, 2 and 3.

Algorithm 1 is algorithm 2 with one path in the memory; algorithm 3 is algorithm 2 on a robot, where
`learn` is called on arrival with eq. 7's discount. Plain Q-learning is an empty memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TypedDict

from swarm.geometry import MOVES
from swarm.learning.memory import ImitationMemory, MemorySnapshot, RememberedPath
from swarm.learning.q_table import QTable
from swarm.learning.random import Rng, RngState, restore_rng, rng_state
from swarm.learning.snapshot import count, finite


class QIncrease(Enum):
    """What has to be positive for a replay to count into n_Q+ ("the average Q value increased")."""

    ASKED = "asked"
    """The sum of the changes that the learning rule asks for, however small."""
    STORED = "stored"
    """The sum of the changes of the stored values: one too small for a value to move is none."""
    AVERAGE = "average"
    """The change of the table's average: one too small for the sum of all values to move is none."""


class Outcome(Enum):
    """How the replay of a path ended."""

    COMPLETED = "completed"
    REJECTED = "rejected"
    BLOCKED = "blocked"
    GOAL = "goal"


@dataclass
class Replay:
    """The imitation of one path from its start to its end."""

    remembered: RememberedPath
    index: int = 0
    q_change: float = 0.0

    def snapshot(self) -> ReplaySnapshot:
        return {"path": self.remembered.number, "index": self.index, "q_change": self.q_change}


@dataclass(frozen=True)
class EndedReplay:
    """A replay that is over: which path, after how many executed moves, how, and what it changed."""

    remembered: RememberedPath
    moves: int
    outcome: Outcome
    q_change: float


class ReplaySnapshot(TypedDict):
    """A replay under way, as JSON can hold it."""

    path: int
    """The number of the path."""
    index: int
    q_change: float


class ControllerSnapshot(TypedDict):
    """A controller, as JSON can hold it."""

    q: list[list[float]]
    memory: MemorySnapshot
    replay: ReplaySnapshot | None
    rng: RngState


class Controller:
    """Chooses actions and learns from them; ask `choose`, act, then tell `learn`.

    `increase` is what counts towards n_Q+; `checks_last` subjects a path's last action to the Q check too.
    """

    def __init__(
        self,
        q: QTable,
        memory: ImitationMemory,
        epsilon: float,
        rng: Rng,
        *,
        increase: QIncrease = QIncrease.ASKED,
        checks_last: bool = False,
    ) -> None:
        self.q = q
        self.memory = memory
        self.epsilon = epsilon
        self.rng = rng
        self.increase = increase
        self.checks_last = checks_last
        self.replay: Replay | None = None
        self.ended: EndedReplay | None = None
        """The replay that the last call of `choose` or `learn` ended, if it ended one."""

    def choose(self, state: int) -> int:
        """The next action: of the path being replayed, of a path now started, or epsilon-greedy.

        As the listings print it, a path's last action is executed without the Q check; the text has "the
        same check at each step", which `checks_last` does.
        """
        self.ended = None
        if self.replay is None:
            self.replay = self._started()
            last = False
        else:
            self.replay.index += 1
            last = self.replay.index == len(self.replay.remembered.path) - 1
        if self.replay is None:
            return self._epsilon_greedy(state)
        action = self.replay.remembered.path.action(self.replay.index, state, self.rng)
        if (self.checks_last or not last) and self.q.has_better(state, action):
            self._end(Outcome.REJECTED, executed=self.replay.index)
            return self._epsilon_greedy(state)
        return action

    def learn(
        self,
        state: int,
        action: int,
        reward: float,
        next_state: int,
        discount: float,
        *,
        blocked: bool = False,
        arrived: bool = False,
    ) -> float:
        """Update Q(s, a) by eq. 1 or 7 and return its change; end the replay where the path ends.

        A replay ends with its last action, at a wall or obstacle (`blocked`), or in the goal
        (`arrived`). The change of its last action counts towards the comparison of average Q values
        (section 2.2, approach 3), which makes no difference to speak of: without it the R values of
        figure 14 are lower by 0.01.
        """
        self.ended = None
        value, total = self.q.values[state][action], self.q.total
        change = self.q.update(state, action, reward, next_state, discount)
        if self.replay is not None:
            stored, average = self.q.values[state][action] - value, self.q.total - total
            self.replay.q_change += self._counted(change, stored, average)
            outcome = self._outcome(self.replay, blocked=blocked, arrived=arrived)
            if outcome is not None:
                self._end(outcome, executed=self.replay.index + 1)
        return change

    def _counted(self, asked: float, stored: float, average: float) -> float:
        """Which of an update's changes counts."""
        match self.increase:
            case QIncrease.ASKED:
                return asked
            case QIncrease.STORED:
                return stored
            case QIncrease.AVERAGE:
                return average

    def _started(self) -> Replay | None:
        if not self.memory.remembered:
            return None
        chosen = self.memory.choose(self.rng)
        return Replay(chosen) if self.memory.p_imitate(chosen) > self.rng.random() else None

    def _epsilon_greedy(self, state: int) -> int:
        """Two random numbers, whatever they decide."""
        explores = self.epsilon > self.rng.random()
        actions = range(MOVES) if explores else self.q.best_actions(state)
        return actions[int(self.rng.integers(len(actions)))]

    @staticmethod
    def _outcome(replay: Replay, *, blocked: bool, arrived: bool) -> Outcome | None:
        if replay.index == len(replay.remembered.path) - 1:
            return Outcome.COMPLETED
        if arrived:
            return Outcome.GOAL
        return Outcome.BLOCKED if blocked else None

    def _end(self, outcome: Outcome, executed: int) -> None:
        """Count the replay into R_i; n_Q+ counts those whose changes of Q sum to more than 0."""
        assert self.replay is not None
        remembered, q_change = self.replay.remembered, self.replay.q_change
        remembered.n_replicated += 1
        remembered.n_completed += outcome is Outcome.COMPLETED
        remembered.n_q_plus += q_change > 0
        self.ended = EndedReplay(remembered, executed, outcome, q_change)
        self.replay = None

    def snapshot(self) -> ControllerSnapshot:
        """Table, memory, the replay under way, and the random numbers to come."""
        return {
            "q": self.q.snapshot(),
            "memory": self.memory.snapshot(),
            "replay": self.replay.snapshot() if self.replay else None,
            "rng": rng_state(self.rng),
        }

    def restore(self, saved: ControllerSnapshot) -> None:
        """Go on from a snapshot; ValueError if it does not fit."""
        self.q.restore(saved["q"])
        self.memory.restore(saved["memory"])
        restore_rng(self.rng, saved["rng"])
        replay = saved["replay"]
        self.replay = self._restored(replay) if replay else None

    def _restored(self, saved: ReplaySnapshot) -> Replay:
        remembered = self.memory.numbered(saved["path"])
        return Replay(remembered, count(saved["index"], len(remembered.path) - 1), finite(saved["q_change"]))
