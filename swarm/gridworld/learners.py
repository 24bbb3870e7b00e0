"""The state of a run's agents as arrays, made ready for the state."""

from __future__ import annotations

import math

import numpy as np

from swarm.geometry import MOVES
from swarm.gridworld import state
from swarm.gridworld.arena import Arena, offsets, ways
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
from swarm.gridworld.splitmix import stream_word
from swarm.gridworld.state import Agent, BestPath, Learner, Rules, World
from swarm.learning.memory import Approach
from swarm.learning.q_table import ALPHA, GAMMA

APPROACHES = {
    Approach.FIXED: state.FIXED,
    Approach.COMPLETION: state.COMPLETION,
    Approach.AVERAGE_Q: state.AVERAGE_Q,
}


def world(arena: Arena) -> World:
    """An arena as the kernels see it."""
    ends = np.uint64(arena.grid.start), np.uint64(arena.grid.goal)
    return World(ways(arena), offsets(arena), *ends, np.array(arena.expert_path, np.uint8))


def learners(condition: Condition, seed: int, run: int) -> tuple[Learner, Learner]:
    """The first learner, and its teacher or the other learner: both have learnt nothing yet."""
    points = (condition.point_limit, condition.point_limit if condition.learners == 2 else 0)
    one, two = (
        Learner(_agent(condition, seed, run, name), settings, _best_path(condition, limit, seed, run, name))
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
        every=teacher.every if isinstance(teacher, Expert | Experienced | EachOther) else 1,
        moves=_moves(teacher),
        accesses=isinstance(teacher, AccessExpert | AccessEachOther),
        seen=False,
    )
    match teacher:
        case Expert():
            return rules._replace(watches=state.WATCHES_EXPERT), rules
        case Experienced():
            return rules._replace(watches=state.WATCHES_OTHER), rules._replace(seen=True)
        case EachOther():
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


def _agent(condition: Condition, seed: int, run: int, name: str) -> Agent:
    states, capacity = condition.arena.grid.states, condition.capacity
    moves = _moves(condition.teacher)
    return Agent(
        q=np.zeros(states * MOVES),
        best=np.zeros(states),
        greedy=np.full(states, (1 << MOVES) - 1, np.uint8),
        place=np.full(1, condition.arena.grid.start, np.uint64),
        arrivals=np.zeros(1, np.int64),
        stream=np.array([stream_word(seed, run, name, "choices")], np.uint64),
        watching=np.array([stream_word(seed, run, name, "watching")], np.uint64),
        paths=np.zeros((capacity, moves), np.uint8),
        lengths=np.zeros(capacity, np.int64),
        replicated=np.zeros(capacity, np.int64),
        counted=np.zeros(capacity, np.int64),
        ratios=np.zeros(capacity),
        totals=np.zeros(capacity),
        remembered=np.zeros(1, np.int64),
        replayed=np.full(1, state.NO_REPLAY, np.int64),
        place_in_path=np.zeros(1, np.int64),
        change=np.zeros(1),
        trail=np.zeros(moves, np.uint8),
        trail_moves=np.zeros(1, np.int64),
        shown=np.zeros(moves, np.uint8),
        shown_moves=np.zeros(1, np.int64),
    )


def _best_path(condition: Condition, points: int, seed: int, run: int, name: str) -> BestPath:
    """Room for `points` evaluations; their random numbers are their own and disturb no learning."""
    return BestPath(
        route=np.zeros(condition.arena.longest_path, np.uint16),
        sets=np.zeros(condition.arena.longest_path, np.uint8),
        length=np.zeros(1, np.int64),
        stream=np.array([stream_word(seed, run, name, "best path")], np.uint64),
        lengths=np.zeros(points, np.int16),
    )
