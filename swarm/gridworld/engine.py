"""One run of a condition, compiled: what a study repeats a hundred times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import MOVES
from swarm.gridworld import kernels
from swarm.gridworld.arena import Arena, expert_values, offsets, ways
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    EachOther,
    Experienced,
    Expert,
    GivenPaths,
    NoTeacher,
    Teacher,
)
from swarm.gridworld.kernels import Agent, BestPath, Limits, Rules, World
from swarm.gridworld.splitmix import stream_word
from swarm.learning.memory import Approach
from swarm.learning.q_table import ALPHA, GAMMA

UNLIMITED = 2**62
APPROACHES = {
    Approach.FIXED: kernels.FIXED,
    Approach.COMPLETION: kernels.COMPLETION,
    Approach.AVERAGE_Q: kernels.AVERAGE_Q,
}


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
        arena, teacher = condition.arena, condition.teacher
        self.world = World(
            ways(arena), offsets(arena), np.uint64(arena.grid.start), np.uint64(arena.grid.goal)
        )
        self.rules, self.two_rules = rules(condition)
        self.one, self.two = (new_agent(condition, seed, run, name) for name in ("one", "two"))
        self.found = best_path(arena, condition.point_limit, seed, run, "one")
        two_points = condition.point_limit if condition.learners == 2 else 0
        self.two_found = best_path(arena, two_points, seed, run, "two")
        self.expert_path = np.array(arena.expert_path, np.uint8)
        self._prepare(teacher)

    def _prepare(self, teacher: Teacher) -> None:
        match teacher:
            case GivenPaths(paths):
                for path in paths:
                    kernels.remember(self.one, self.rules, np.array(path.moves, np.uint8), 0, len(path))
            case Experienced(goal_reachings=goal_reachings):
                self._educate(goal_reachings)
            case AccessExpert(moves):
                self.two.q[:] = expert_values(self.condition.arena, GAMMA).ravel()
                kernels.prepare(self.two)
                remember_policy(self.one, self.rules, moves)
            case AccessEachOther(moves):
                remember_policy(self.one, self.rules, moves)
                remember_policy(self.two, self.two_rules, moves)

    def _educate(self, goal_reachings: int) -> None:
        """Let the teacher learn alone."""
        alone = Limits(UNLIMITED, goal_reachings, UNLIMITED, pair=False)
        teacher, found = self.two, self.two_found
        kernels.run(
            self.world, teacher, self.one, self.two_rules, self.rules, found, found, self.expert_path, alone
        )

    def advance(self, steps: int | None = None) -> int:
        """Go on for a number of steps (None: to the end of the run); return how many were taken."""
        condition = self.condition
        limits = Limits(
            condition.steps or UNLIMITED if steps is None else steps,
            condition.goal_reachings or UNLIMITED,
            condition.evaluate_every,
            isinstance(condition.teacher, EachOther | AccessEachOther | Experienced),
        )
        return int(
            kernels.run(
                self.world,
                self.one,
                self.two,
                self.rules,
                self.two_rules,
                self.found,
                self.two_found,
                self.expert_path,
                limits,
            )
        )

    def trace(self, steps: int) -> Trace:
        """What the run shows after `steps` steps."""
        learners = [(self.one, self.found), (self.two, self.two_found)][: self.condition.learners]
        points = min(steps // self.condition.evaluate_every, self.condition.point_limit)
        lengths = np.array([found.lengths[:points] for _, found in learners], np.int32)
        most = max(int(agent.remembered[0]) for agent, _ in learners)
        ratios = np.full((len(learners), most), np.nan)
        for row, (agent, _) in zip(ratios, learners, strict=True):
            row[: agent.remembered[0]] = agent.ratios[: agent.remembered[0]]
        return Trace(lengths, ratios, steps)


def rules(condition: Condition) -> tuple[Rules, Rules]:
    """The settings of the two agents of a condition."""
    watches, two_watches, moves, every = kernels.WATCHES_NOBODY, kernels.WATCHES_NOBODY, 1, 1
    accesses = two_seen = False
    match condition.teacher:
        case Expert(moves, every):
            watches = kernels.WATCHES_EXPERT
        case Experienced(moves, every) | EachOther(moves, every):
            watches, two_seen = kernels.WATCHES_OTHER, True
            if isinstance(condition.teacher, EachOther):
                two_watches = kernels.WATCHES_OTHER
        case AccessExpert(moves) | AccessEachOther(moves):
            accesses = True
        case GivenPaths(paths):
            moves = max((len(path) for path in paths), default=1)
        case NoTeacher():
            pass

    explores_below = np.uint64(math.ceil(condition.epsilon * 2**53))

    def made(watched: int, seen: bool) -> Rules:
        return Rules(
            ALPHA, GAMMA, explores_below, condition.beta, APPROACHES[condition.approach],
            watched, every, moves, accesses, seen,
        )  # fmt: skip

    return made(watches, two_watches != kernels.WATCHES_NOBODY), made(two_watches, two_seen)


def new_agent(condition: Condition, seed: int, run: int, name: str) -> Agent:
    """An agent that has learnt nothing and remembers nothing."""
    states, capacity = condition.arena.grid.states, condition.capacity
    moves = rules(condition)[0].moves
    counts = {
        field: np.zeros(1, np.int64)
        for field in ("arrivals", "remembered", "place_in_path", "trail_moves", "shown_moves")
    }
    return Agent(
        q=np.zeros(states * MOVES),
        best=np.zeros(states),
        greedy=np.full(states, kernels.ALL_MOVES, np.uint8),
        place=np.full(1, condition.arena.grid.start, np.uint64),
        stream=np.array([stream_word(seed, run, name, "choices")], np.uint64),
        watching=np.array([stream_word(seed, run, name, "watching")], np.uint64),
        paths=np.zeros((capacity, moves), np.uint8),
        lengths=np.zeros(capacity, np.int64),
        replicated=np.zeros(capacity, np.int64),
        counted=np.zeros(capacity, np.int64),
        ratios=np.zeros(capacity),
        totals=np.zeros(capacity),
        replayed=np.full(1, kernels.NO_REPLAY, np.int64),
        change=np.zeros(1),
        trail=np.zeros(moves, np.uint8),
        shown=np.zeros(moves, np.uint8),
        **counts,
    )


def best_path(arena: Arena, points: int, seed: int, run: int, name: str) -> BestPath:
    """Room for `points` evaluations; their random numbers are their own and disturb no learning."""
    return BestPath(
        route=np.zeros(arena.longest_path, np.uint16),
        sets=np.zeros(arena.longest_path, np.uint8),
        length=np.zeros(1, np.int64),
        stream=np.array([stream_word(seed, run, name, "best path")], np.uint64),
        lengths=np.zeros(points, np.int16),
    )


def remember_policy(agent: Agent, rules: Rules, moves: int) -> None:
    """Section 2.4: the one path of the memory is the other's policy, whatever moves it will give."""
    kernels.remember(agent, rules, np.zeros(moves, np.uint8), 0, moves)
