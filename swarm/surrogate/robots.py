"""Robots without wheels: algorithm 3 with the very same rules, on measured durations.

Each robot has its own time. A move takes what such moves were measured to take; a visit takes the time of
watching, and what is copied is drawn from stored copies of what the demonstrator did meanwhile.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from dataclasses import dataclass

from swarm.config.experiment import Experiment, RobotSettings, Role
from swarm.geometry import Move
from swarm.learning.expert import Plan, expert_move
from swarm.learning.greedy_path import greedy_path
from swarm.learning.learner import Transition
from swarm.learning.memory import ImitationMemory
from swarm.surrogate.durations import (
    DRIVE_BACK,
    HEADING_AFTER_THE_DRIVE_BACK,
    HEADING_AT_THE_START,
    Durations,
    kind_of,
)

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
        self.grid = experiment.compartment(settings).grid
        self._blocked_move_s = experiment.learning.blocked_move_s
        self._state, self._heading = self.grid.start, HEADING_AT_THE_START
        self._durations = durations
        self._duration_rng = experiment.generator(settings, trial, "durations")

    def move(self) -> None:
        """Choose, move, learn; from the goal drive back to the start."""
        transition = self._made(self.choose(self._state))
        self.learn(transition)
        self._show(transition)
        self.t_s += transition.duration_s
        self.moves += 1
        self._state = transition.next_state
        if self._state == self.grid.goal:
            self.tracks += 1
            self.t_s += self._durations.drawn(DRIVE_BACK, self._duration_rng)
            self.begin_at_start(HEADING_AFTER_THE_DRIVE_BACK)

    def begin_at_start(self, heading: int) -> None:
        """Stand in the start cell: after a drive back, or carried there after a visit."""
        self._state, self._heading = self.grid.start, heading

    def _made(self, action: int) -> Transition:
        entered = self.grid.neighbour(self._state, action)
        if entered is None:
            return Transition(self._state, action, self._state, self._blocked_move_s, blocked=True)
        duration_s = self._durations.drawn(kind_of(self._heading, action), self._duration_rng)
        return Transition(self._state, action, entered, duration_s, blocked=False)

    def _show(self, transition: Transition) -> None:
        """A move into a wall is decided, not driven: nobody can see it."""
        if not transition.blocked:
            self._heading = transition.action
            ends_s = self.t_s + transition.duration_s
            self.shown.append(ShownMoves(Move(transition.action), self.t_s, ends_s, self.tracks))

    @abstractmethod
    def choose(self, state: int) -> int:
        """The move to make from the centre of a cell."""

    @abstractmethod
    def learn(self, transition: Transition) -> None:
        """Take in what came of the last choice."""


class SurrogateExpert(SurrogateRobot):
    """Follows its plan, the shortest path unless another is given, for ever."""

    plan: Plan = staticmethod(expert_move)

    def choose(self, state: int) -> int:
        return self.plan(self.grid, state)

    def learn(self, transition: Transition) -> None:
        """An expert has nothing to learn."""


class SurrogateLearner(SurrogateRobot):
    """Algorithm 3 with eq. 7: the very same learner as on a robot."""

    def __init__(
        self, experiment: Experiment, settings: RobotSettings, durations: Durations, trial: int
    ) -> None:
        super().__init__(experiment, settings, durations, trial)
        self.learner = experiment.learner(settings, trial)
        for path in settings.given_paths():
            self.learner.remember(path)
        self.copy_rng = experiment.generator(settings, trial, "copies")
        self.visits = 0
        self.best_paths: list[int] = []
        """The greedy path's length after every ten moves."""
        self.learnt_paths: list[int] = []
        """The same, the cap where it passes a cell in which nothing has been learnt."""
        self._strict_rng = experiment.generator(settings, trial, "learnt path")

    @property
    def memory(self) -> ImitationMemory:
        return self.learner.controller.memory

    def choose(self, state: int) -> int:
        return self.learner.choose(state).action

    def learn(self, transition: Transition) -> None:
        length = self.learner.learn(transition).best_path_length
        if length is not None:
            self.best_paths.append(length)
            self.learnt_paths.append(self._learnt_length())

    def _learnt_length(self) -> int:
        cap = self.learner.path_length_cap
        path = greedy_path(self.learner.controller.q, self.grid, self._strict_rng, cap)
        return cap if path.by_luck else path.length


def surrogate_robot(
    experiment: Experiment,
    settings: RobotSettings,
    durations: Durations,
    trial: int,
    plan: Plan = expert_move,
) -> SurrogateRobot:
    """An expert goes by `plan`."""
    if settings.role is not Role.EXPERT:
        return SurrogateLearner(experiment, settings, durations, trial)
    expert = SurrogateExpert(experiment, settings, durations, trial)
    expert.plan = plan
    return expert
