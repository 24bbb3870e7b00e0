"""The engine's runs with the plain controller: what the compiled engine has to equal, bit for bit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from swarm.geometry import Move
from swarm.gridworld.arena import expert_values
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    CopyEachOther,
    CopyExperienced,
    CopyExpert,
    GivenPaths,
    Precision,
)
from swarm.gridworld.splitmix import SplitMix64, stream_word
from swarm.learning.controller import Controller
from swarm.learning.greedy_path import greedy_path_length
from swarm.learning.memory import AccessedPolicy, ImitationMemory, ObservedPath
from swarm.learning.q_table import GAMMA, QTable


class SingleQTable(QTable):
    """Each stored value is a 32-bit float."""

    def update(self, state: int, action: int, reward: float, next_state: int, discount: float) -> float:
        value, total = self.values[state][action], self.total
        change = super().update(state, action, reward, next_state, discount)
        self.values[state][action] = float(np.float32(self.values[state][action]))
        self.total = total + (self.values[state][action] - value)
        return change


def _table(condition: Condition) -> QTable:
    table = SingleQTable if condition.precision is Precision.SINGLE else QTable
    return table(condition.arena.grid.states)


class PlainAgent:
    """A controller that walks the arena; it keeps the moves of this run and of the one before."""

    def __init__(self, condition: Condition, seed: int, run: int, name: str) -> None:
        def stream(component: str) -> SplitMix64:
            return SplitMix64(stream_word(seed, run, name, component))

        memory = ImitationMemory(condition.beta, condition.approach, condition.capacity)
        self.grid = condition.arena.grid
        self.controller = Controller(
            _table(condition),
            memory,
            condition.epsilon,
            stream("choices"),
            increase=condition.increase,
            checks_last=condition.checks_last,
        )
        self.watching, self.evaluating = stream("watching"), stream("best path")
        self.state, self.arrivals = self.grid.start, 0
        self.moves: list[int] = []
        self.shown: list[int] = []
        self.lengths: list[int] = []

    def step(self) -> bool:
        action = self.controller.choose(self.state)
        entered = self.grid.neighbour(self.state, action)
        after = self.state if entered is None else entered
        arrived = after == self.grid.goal
        self.controller.learn(
            self.state, action, float(arrived), after, GAMMA, blocked=entered is None, arrived=arrived
        )
        self.moves.append(action)
        self.state = after
        if arrived:
            self.state, self.shown, self.moves = self.grid.start, self.moves, []
            self.arrivals += 1
        return arrived

    def seen_moves(self, count: int) -> list[int]:
        enough = len(self.moves) >= min(count, len(self.shown))
        return (self.moves if enough else self.shown)[-count:]

    def remember(self, moves: Sequence[int]) -> None:
        self.controller.memory.remember(ObservedPath(tuple(Move(move) for move in moves)))


class PlainSimulation:
    """A run of a condition with one or two plain agents."""

    def __init__(self, condition: Condition, seed: int, run: int) -> None:
        self.condition = condition
        self.one, self.two = (PlainAgent(condition, seed, run, name) for name in ("one", "two"))
        self.taken = 0
        match condition.teacher:
            case GivenPaths(paths):
                for path in paths:
                    self.one.controller.memory.remember(path)
            case CopyExperienced(goal_reachings=goal_reachings):
                while self.two.arrivals < goal_reachings:
                    self.two.step()
            case AccessExpert(moves):
                expert = QTable(condition.arena.grid.states)
                expert.values = expert_values(condition.arena, GAMMA).tolist()
                self.one.controller.memory.remember(AccessedPolicy(expert, moves))
            case AccessEachOther(moves):
                self.one.controller.memory.remember(AccessedPolicy(self.two.controller.q, moves))
                self.two.controller.memory.remember(AccessedPolicy(self.one.controller.q, moves))
        if isinstance(condition.teacher, CopyExpert | CopyExperienced) and condition.teacher.copies_at_once:
            self.one.remember(self._demonstration(self.one, self.two, condition.teacher))

    def step(self) -> None:
        teacher = self.condition.teacher
        self._step(self.one, self.two, isinstance(teacher, CopyExpert | CopyExperienced | CopyEachOther))
        if self.condition.learners == 2 or isinstance(teacher, CopyExperienced):
            self._step(self.two, self.one, isinstance(teacher, CopyEachOther))
        self.taken += 1
        if self.taken % self.condition.evaluate_every == 0:
            self._evaluate(self.one)
            if self.condition.learners == 2:
                self._evaluate(self.two)

    def _step(self, agent: PlainAgent, other: PlainAgent, watches: bool) -> None:
        teacher = self.condition.teacher
        if not agent.step() or not watches:
            return
        assert isinstance(teacher, CopyExpert | CopyExperienced | CopyEachOther)
        if agent.arrivals % teacher.every == 0:
            agent.remember(self._demonstration(agent, other, teacher))

    def _demonstration(
        self, agent: PlainAgent, other: PlainAgent, teacher: CopyExpert | CopyExperienced | CopyEachOther
    ) -> Sequence[int]:
        if not isinstance(teacher, CopyExpert):
            return other.seen_moves(teacher.moves)
        path = self.condition.arena.expert_path
        first = agent.watching.integers(len(path) - teacher.moves + 1)
        return path[first : first + teacher.moves]

    def _evaluate(self, agent: PlainAgent) -> None:
        cap = self.condition.arena.longest_path
        agent.lengths.append(greedy_path_length(agent.controller.q, agent.grid, agent.evaluating, cap))
