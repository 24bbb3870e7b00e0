"""One run of a condition, compiled: what a study repeats a hundred times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm.gridworld import kernels
from swarm.gridworld.arena import expert_values
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    EachOther,
    Experienced,
    Expert,
    GivenPaths,
)
from swarm.gridworld.learners import learners, world
from swarm.gridworld.state import Learner, Limits
from swarm.learning.q_table import GAMMA

UNLIMITED = 2**62


@dataclass(frozen=True)
class Trace:
    """What a run leaves behind."""

    best_path_length: NDArray[np.int32]
    """The best path at each evaluation, `arena.longest_path` if it did not arrive (learners, points)."""
    ratios: NDArray[np.float64]
    """R_i of each path in the memory at the end, NaN where there is none (learners, memory paths)."""
    steps: int
    """Time steps that the run took."""


def simulate(condition: Condition, seed: int, run: int) -> Trace:
    """Run number `run` of a condition; the same numbers for the same (condition, seed, run), anywhere.

    A run that ends by its goal reachings has the points it came to.
    """
    simulation = Simulation(condition, seed, run)
    steps = simulation.advance()
    return simulation.trace(steps)


class Simulation:
    """The state of a run: `one` is the first learner, `two` its teacher or the other learner, if any."""

    def __init__(self, condition: Condition, seed: int, run: int) -> None:
        self.condition = condition
        self.world = world(condition.arena)
        self.one, self.two = learners(condition, seed, run)
        match condition.teacher:
            case GivenPaths(paths):
                for path in paths:
                    _remember(self.one, np.array(path.moves, np.uint8))
            case Experienced(goal_reachings=goal_reachings):
                self._train_teacher(goal_reachings)
                kernels.copy_moves(self.world, self.one, self.two)
            case Expert():
                kernels.copy_moves(self.world, self.one, self.two)
            case AccessExpert(moves):
                self.two.agent.q[:] = expert_values(condition.arena, GAMMA).ravel()
                kernels.prepare(self.two.agent)
                _remember(self.one, _any_moves(moves))
            case AccessEachOther(moves):
                _remember(self.one, _any_moves(moves))
                _remember(self.two, _any_moves(moves))

    def _train_teacher(self, goal_reachings: int) -> None:
        """Alone, and faster while nobody will see its moves: only those of its last run may be copied."""
        unseen = self.two._replace(rules=self.two.rules._replace(seen=False))
        for teacher, reachings in ((unseen, goal_reachings - 1), (self.two, goal_reachings)):
            alone = Limits(UNLIMITED, reachings, UNLIMITED, pair=False)
            kernels.run(self.world, teacher, self.one, alone)

    def advance(self, steps: int | None = None) -> int:
        """Go on for a number of steps (None: to the end of the run); return how many were taken."""
        condition = self.condition
        limits = Limits(
            steps or condition.steps or UNLIMITED,
            condition.goal_reachings or UNLIMITED,
            condition.evaluate_every,
            pair=isinstance(condition.teacher, EachOther | AccessEachOther | Experienced),
        )
        return int(kernels.run(self.world, self.one, self.two, limits))

    def trace(self, steps: int) -> Trace:
        """What the run shows after `steps` steps."""
        shown = [self.one, self.two][: self.condition.learners]
        points = min(steps // self.condition.evaluate_every, self.condition.point_limit)
        lengths = np.array([learner.found.lengths[:points] for learner in shown], np.int32)
        counts = [int(learner.agent.remembered[0]) for learner in shown]
        ratios = np.full((len(shown), max(counts)), np.nan)
        for row, learner, count in zip(ratios, shown, counts, strict=True):
            row[:count] = learner.agent.ratios[:count]
        return Trace(lengths, ratios, steps)


def _remember(learner: Learner, moves: NDArray[np.uint8]) -> None:
    kernels.remember(learner.agent, learner.rules, moves, 0, len(moves))


def _any_moves(count: int) -> NDArray[np.uint8]:
    """Section 2.4: the one path of the memory is the other's policy; only its length is in the memory."""
    return np.zeros(count, np.uint8)
