"""One run of a condition: the state of its agents made ready, and the compiled engine over it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import MOVES
from swarm.gridworld import kernels, state
from swarm.gridworld.arena import Arena, expert_values, offsets, ways
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    CopyEachOther,
    CopyExperienced,
    CopyExpert,
    GivenPaths,
    NoTeacher,
    Precision,
    Teacher,
)
from swarm.gridworld.splitmix import stream_word
from swarm.gridworld.state import (
    UNLIMITED,
    AgentArrays,
    ArenaArrays,
    BestPathArrays,
    LearnerArrays,
    Limits,
    Rules,
)
from swarm.learning.controller import QIncrease
from swarm.learning.memory import Approach
from swarm.learning.q_table import ALPHA, GAMMA


@dataclass(frozen=True)
class Trace:
    """What a run leaves behind."""

    best_path_length: NDArray[np.int32]
    """The best path at each evaluation, `arena.longest_path` if it did not arrive (learners, points)."""
    ratios: NDArray[np.float64]
    """R_i of each path in the memory at the end, NaN where there is none (learners, memory paths)."""
    steps: int
    """Time steps that the run took."""
    replicated: NDArray[np.int64]
    """How often each path in the memory at the end was replayed (learners, memory paths)."""
    tally: NDArray[np.int64]
    """`state.COPIED`, `TRIED`, `SUGGESTED`, `SUGGESTED_AT_RANDOM` (learners, 4)."""
    q_error: NDArray[np.float64]
    """The greatest distance of a Q value from that of one who has learnt all there is (learners,)."""


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
            case CopyExperienced(goal_reachings=goal_reachings):
                self._train_teacher(goal_reachings)
            case AccessExpert(moves):
                self.two.agent.q[:] = expert_values(condition.arena, GAMMA).ravel()
                kernels.prepare(self.two.agent)
                _remember(self.one, _any_moves(moves))
            case AccessEachOther(moves):
                _remember(self.one, _any_moves(moves))
                _remember(self.two, _any_moves(moves))
        if getattr(condition.teacher, "copies_at_once", False):
            kernels.copy_moves(self.world, self.one, self.two)

    def _train_teacher(self, goal_reachings: int) -> None:
        """Alone, and faster while nobody will see its moves: only those of its last run may be copied."""
        unseen = self.two._replace(rules=self.two.rules._replace(seen=False))
        for teacher, reachings in ((unseen, goal_reachings - 1), (self.two, goal_reachings)):
            alone = Limits(UNLIMITED, reachings, UNLIMITED, False, UNLIMITED, UNLIMITED)
            kernels.run(self.world, teacher, self.one, alone)

    def advance(self, steps: int | None = None) -> int:
        """Go on for a number of steps (None: to the end of the run); return how many were taken."""
        condition = self.condition
        limits = Limits(
            steps or condition.steps or UNLIMITED,
            condition.goal_reachings or UNLIMITED,
            condition.evaluate_every,
            pair=condition.learners == 2 or isinstance(condition.teacher, CopyExperienced),
            points=condition.point_limit,
            later_every=condition.later_every or UNLIMITED,
        )
        return int(kernels.run(self.world, self.one, self.two, limits))

    def trace(self, steps: int) -> Trace:
        """What the run shows after `steps` steps."""
        shown = [self.one, self.two][: self.condition.learners]
        points = len(self.condition.evaluated_steps(steps))
        lengths = np.array([learner.found.lengths[:points] for learner in shown], np.int32)
        counts = [int(learner.agent.remembered[0]) for learner in shown]
        ratios = np.full((len(shown), max(counts)), np.nan)
        replicated = np.zeros((len(shown), max(counts)), np.int64)
        for place, (learner, count) in enumerate(zip(shown, counts, strict=True)):
            ratios[place, :count] = learner.agent.ratios[:count]
            replicated[place, :count] = learner.agent.n_replicated[:count]
        tally = np.array([learner.agent.tally for learner in shown])
        return Trace(lengths, ratios, steps, replicated, tally, self._q_errors(shown))

    def _q_errors(self, shown: list[LearnerArrays]) -> NDArray[np.float64]:
        learnt = expert_values(self.condition.arena, GAMMA).ravel()
        return np.array([np.abs(learner.agent.q - learnt).max() for learner in shown])


def _remember(learner: LearnerArrays, moves: NDArray[np.uint8]) -> None:
    kernels.remember(learner.agent, learner.rules, moves, 0, len(moves))


def _any_moves(count: int) -> NDArray[np.uint8]:
    """Section 2.4: the one path of the memory is the other's policy; only its length is in the memory."""
    return np.zeros(count, np.uint8)


APPROACHES = {
    Approach.FIXED: state.FIXED,
    Approach.COMPLETION: state.COMPLETION,
    Approach.AVERAGE_Q: state.AVERAGE_Q,
}


INCREASES = {
    QIncrease.ASKED: state.ASKED,
    QIncrease.STORED: state.STORED,
    QIncrease.AVERAGE: state.AVERAGE,
}


def world(arena: Arena) -> ArenaArrays:
    """An arena as the kernels see it."""
    ends = np.uint64(arena.grid.start), np.uint64(arena.grid.goal)
    return ArenaArrays(ways(arena), offsets(arena), *ends, np.array(arena.expert_path, np.uint8))


def learners(condition: Condition, seed: int, run: int) -> tuple[LearnerArrays, LearnerArrays]:
    """The first learner, and its teacher or the other learner: both have learnt nothing yet."""
    room = condition.point_limit + condition.later_points
    points = (room, room if condition.learners == 2 else 0)
    one, two = (
        LearnerArrays(
            _agent(condition, seed, run, name), settings, _best_path(condition, limit, seed, run, name)
        )
        for name, settings, limit in zip(("one", "two"), _rules(condition), points, strict=True)
    )
    return one, two


def _rules(condition: Condition) -> tuple[Rules, Rules]:
    """The settings of the two."""
    teacher = condition.teacher
    rules = Rules(
        alpha=ALPHA,
        gamma=GAMMA,
        explores_below=np.uint64(math.ceil(condition.epsilon * 2**53)),
        beta=condition.beta,
        approach=APPROACHES[condition.approach],
        watches=state.WATCHES_NOBODY,
        every=teacher.every if isinstance(teacher, CopyExpert | CopyExperienced | CopyEachOther) else 1,
        moves=_moves(teacher),
        accesses=isinstance(teacher, AccessExpert | AccessEachOther),
        seen=False,
        increase=INCREASES[condition.increase],
        checks_last=condition.checks_last,
    )
    match teacher:
        case CopyExpert():
            return rules._replace(watches=state.WATCHES_EXPERT), rules
        case CopyExperienced():
            return rules._replace(watches=state.WATCHES_OTHER), rules._replace(seen=True)
        case CopyEachOther():
            both = rules._replace(watches=state.WATCHES_OTHER, seen=True)
            return both, both
    return rules, rules


def _moves(teacher: Teacher) -> int:
    """The moves of the longest path that a memory will hold."""
    match teacher:
        case NoTeacher():
            return 1
        case GivenPaths(paths):
            return max((len(path) for path in paths), default=1)
    return teacher.moves


def _agent(condition: Condition, seed: int, run: int, name: str) -> AgentArrays:
    states, capacity = condition.arena.grid.states, condition.capacity
    moves = _moves(condition.teacher)
    real = np.float32 if condition.precision is Precision.SINGLE else np.float64
    return AgentArrays(
        q=np.zeros(states * MOVES, real),
        best=np.zeros(states, real),
        greedy=np.full(states, (1 << MOVES) - 1, np.uint8),
        state=np.full(1, condition.arena.grid.start, np.uint64),
        arrivals=np.zeros(1, np.int64),
        stream=np.array([stream_word(seed, run, name, "choices")], np.uint64),
        watching=np.array([stream_word(seed, run, name, "watching")], np.uint64),
        paths=np.zeros((capacity, moves), np.uint8),
        lengths=np.zeros(capacity, np.int64),
        n_replicated=np.zeros(capacity, np.int64),
        n_counted=np.zeros(capacity, np.int64),
        ratios=np.zeros(capacity),
        totals=np.zeros(capacity),
        remembered=np.zeros(1, np.int64),
        replay=np.full(1, state.NO_REPLAY, np.int64),
        replay_index=np.zeros(1, np.int64),
        q_change=np.zeros(1),
        q_total=np.zeros(1),
        tally=np.zeros(4, np.int64),
        trail=np.zeros(moves, np.uint8),
        trail_moves=np.zeros(1, np.int64),
        shown=np.zeros(moves, np.uint8),
        shown_moves=np.zeros(1, np.int64),
    )


def _best_path(condition: Condition, points: int, seed: int, run: int, name: str) -> BestPathArrays:
    """Room for `points` evaluations; their random numbers are their own and disturb no learning."""
    return BestPathArrays(
        route=np.zeros(condition.arena.longest_path, np.uint16),
        sets=np.zeros(condition.arena.longest_path, np.uint8),
        length=np.zeros(1, np.int64),
        stream=np.array([stream_word(seed, run, name, "best path")], np.uint64),
        lengths=np.zeros(points, np.int16),
        counts_luck=condition.counts_luck,
    )
