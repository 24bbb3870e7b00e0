"""Robots without wheels: algorithm 3 with the very same rules, on measured durations.

Each robot has its own time. A move takes what such moves were measured to take; a visit takes the time of
watching, and what is copied is drawn from stored copies of what the demonstrator did meanwhile.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from swarm.config.experiment import Experiment, RobotSettings, Role
from swarm.geometry import Grid, Move
from swarm.learning.controller import Controller
from swarm.learning.greedy_path import greedy_path_length
from swarm.learning.memory import ImitationMemory, ObservedPath
from swarm.learning.q_table import QTable, discount_over
from swarm.learning.random import spawned_generator
from swarm.surrogate.durations import (
    DRIVE_BACK,
    HEADING_AFTER_THE_DRIVE_BACK,
    HEADING_AT_THE_START,
    Durations,
    kind_of,
)

MOVES_BETWEEN_EVALUATIONS = 10
MOVES_KEPT = 100
"""More than anybody can watch in a visit."""


@dataclass(frozen=True, slots=True)
class ShownMoves:
    """A move as an observer could see it."""

    move: Move
    began_s: float
    ended_s: float
    track: int


class SurrogateRobot(ABC):
    """Moves from cell to cell in its own time, and can be watched."""

    def __init__(
        self, experiment: Experiment, settings: RobotSettings, durations: Durations, trial: int
    ) -> None:
        self.settings = settings
        self.t_s = 0.0
        self.moves = self.tracks = 0
        self.shown: deque[ShownMoves] = deque(maxlen=MOVES_KEPT)
        self._experiment, self._trial = experiment, trial
        self.grid = Grid(experiment.arena.columns, experiment.arena.rows)
        self._state, self._heading = self.grid.start, HEADING_AT_THE_START
        self._durations = durations
        self._duration_rng = self.generator("durations")

    def generator(self, component: str) -> np.random.Generator:
        """The same streams of random numbers as in a run of the same experiment."""
        seed, robot = self._experiment.run.seed, self.settings
        return spawned_generator(seed, robot.group, self._trial, robot.id, component)

    def move(self) -> None:
        """Choose, move, learn; from the goal drive back to the start."""
        action = self.choose(self._state)
        entered = self.grid.neighbour(self._state, action)
        blocked, next_state = entered is None, self._state if entered is None else entered
        duration_s = self._duration_s(action, blocked)
        arrived = next_state == self.grid.goal
        self.learn(self._state, action, next_state, duration_s, blocked=blocked, arrived=arrived)
        if not blocked:
            self.shown.append(ShownMoves(Move(action), self.t_s, self.t_s + duration_s, self.tracks))
            self._heading = action
        self.t_s += duration_s
        self.moves += 1
        self._state = next_state
        if arrived:
            self.tracks += 1
            self.t_s += self._durations.drawn(DRIVE_BACK, self._duration_rng)
            self.begin_at_start(HEADING_AFTER_THE_DRIVE_BACK)

    def begin_at_start(self, heading: int) -> None:
        """Stand in the start cell: after a drive back, or carried there after a visit."""
        self._state, self._heading = self.grid.start, heading

    def _duration_s(self, action: int, blocked: bool) -> float:
        if blocked:
            return self._experiment.learning.blocked_move_s
        return self._durations.drawn(kind_of(self._heading, action), self._duration_rng)

    @abstractmethod
    def choose(self, state: int) -> int:
        """The move to make from the centre of a cell."""

    @abstractmethod
    def learn(
        self, state: int, action: int, next_state: int, duration_s: float, *, blocked: bool, arrived: bool
    ) -> None:
        """Take in what came of the last choice."""


class SurrogateExpert(SurrogateRobot):
    """Follows the shortest path of a square grid for ever."""

    def choose(self, state: int) -> int:
        column, row = self.grid.cell(state)
        if column == self.grid.columns - 1:
            return Move.S
        return Move.E if row == self.grid.rows - 1 else Move.SE

    def learn(self, *_: int | float, blocked: bool, arrived: bool) -> None:
        """An expert has nothing to learn."""


class SurrogateLearner(SurrogateRobot):
    """Algorithm 3 with eq. 7: the very same controller, memory and table as on a robot."""

    def __init__(
        self, experiment: Experiment, settings: RobotSettings, durations: Durations, trial: int
    ) -> None:
        super().__init__(experiment, settings, durations, trial)
        rules = experiment.learning
        self.rules = rules
        self.memory = ImitationMemory(rules.beta, rules.approach, rules.capacity)
        for path in settings.given_paths():
            self.memory.remember(path)
        self.controller = Controller(
            QTable(self.grid.states), self.memory, rules.epsilon, self.generator("controller")
        )
        self.copy_rng = self.generator("copies")
        self.visits = 0
        self.best_paths: list[int] = []
        """The greedy path's length after every ten moves."""
        self._evaluation_rng = self.generator("evaluation")

    def choose(self, state: int) -> int:
        return self.controller.choose(state)

    def learn(
        self, state: int, action: int, next_state: int, duration_s: float, *, blocked: bool, arrived: bool
    ) -> None:
        discount = discount_over(duration_s, self.rules.discount_rate_per_s)
        reward = discount * (1.0 if arrived else 0.0)
        self.controller.learn(state, action, reward, next_state, discount, blocked=blocked, arrived=arrived)
        if (self.moves + 1) % MOVES_BETWEEN_EVALUATIONS == 0:
            cap = self.rules.path_length_cap
            length = greedy_path_length(self.controller.q, self.grid, self._evaluation_rng, cap)
            self.best_paths.append(length)

    def abandon(self) -> None:
        """A visit ends a replay without counting it."""
        self.controller.replay = None

    def remember(self, moves: Sequence[Move]) -> None:
        self.memory.remember(ObservedPath(tuple(moves)))


def surrogate_robot(
    experiment: Experiment, settings: RobotSettings, durations: Durations, trial: int
) -> SurrogateRobot:
    made = SurrogateExpert if settings.role is Role.EXPERT else SurrogateLearner
    return made(experiment, settings, durations, trial)
