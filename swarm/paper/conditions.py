"""The conditions of section 2, each made in one place, and the two shapes of study made of them."""

from __future__ import annotations

from dataclasses import replace

from swarm.geometry import Move
from swarm.gridworld.arena import OBSTACLE_100, OPEN_10
from swarm.gridworld.condition import (
    AccessEachOther,
    AccessExpert,
    Condition,
    CopyEachOther,
    CopyExperienced,
    CopyExpert,
    GivenPaths,
    NoTeacher,
    Teacher,
)
from swarm.learning.memory import Approach, ObservedPath
from swarm.paper.claim import Better, Claim
from swarm.paper.study import Study

BETAS = (0.1, 0.3, 0.5)
"""Of figures 3 and 5 to 9."""
SMALL_HORIZON_STEPS = 20_000
LARGE_HORIZON_STEPS = 20_000_000
"""How far the paper's figures go: 3 and 5 to 9, and 12 to 21."""
LATER_EVERY_STEPS = 1000
"""On the 10 x 10 arena, between the figures' 20,000 steps and the 100,000th reaching of the goal."""

BENEFICIAL = ObservedPath((Move.SE,) * 5)
"""Figure 2."""
NOT_BENEFICIAL = ObservedPath((Move.E,) * 5)
"""Figure 4."""
EIGHT_PATHS = tuple(ObservedPath((move,) * 20) for move in Move)
"""Figure 11."""


def _small(name: str, teacher: Teacher, beta: float, approach: Approach) -> Condition:
    return Condition(
        name,
        OPEN_10,
        teacher,
        epsilon=0.3,
        beta=beta,
        approach=approach,
        goal_reachings=100_000,
        evaluate_every=10,
        points=SMALL_HORIZON_STEPS // 10,
        later_every=LATER_EVERY_STEPS,
        later_points=3000,  # twice as many as the longest runs have
    )


def _large(name: str, teacher: Teacher) -> Condition:
    return Condition(name, OBSTACLE_100, teacher, epsilon=0.5, beta=0.5, steps=LARGE_HORIZON_STEPS)


def shortened(condition: Condition, steps: int) -> Condition:
    """The condition for so many steps, evaluated all the time."""
    return replace(condition, steps=steps, points=None, later_every=None, later_points=0)


def one_path(approach: Approach, path: ObservedPath, beta: float) -> Condition:
    """Section 2.2: an agent on the 10 x 10 arena with one path in its memory."""
    usefulness = "good" if path == BENEFICIAL else "bad"
    name = f"small_{approach.value}_{usefulness}_{round(100 * beta):02}"
    return _small(name, GivenPaths((path,)), beta, approach)


SMALL_NO_IMITATION = _small("small_no_imitation", NoTeacher(), 0.5, Approach.AVERAGE_Q)

NO_IMITATION = _large("no_imitation", NoTeacher())
NO_IMITATION_PAIR = _large("no_imitation_pair", NoTeacher(learners=2))
"""What pairs that imitate are compared with: the mean of two varies less than one."""
GIVEN_EIGHT_PATHS = _large("eight_paths", GivenPaths(EIGHT_PATHS))
COPYING_EXPERT = _large("copying_expert", CopyExpert())
COPYING_EXPERIENCED = _large("copying_experienced", CopyExperienced())
COPYING_EACH_OTHER = _large("copying_each_other", CopyEachOther())
ACCESSING_EXPERT = _large("accessing_expert", AccessExpert())
ACCESSING_EACH_OTHER = _large("accessing_each_other", AccessEachOther())


def one_path_study(
    name: str, title: str, approach: Approach, path: ObservedPath, claims: tuple[Claim, ...]
) -> Study:
    """Figures 3 and 5-9: the three betas beside no imitation, on the 10 x 10 arena."""
    series = {"no imitation": SMALL_NO_IMITATION}
    series |= {f"β = {beta}": one_path(approach, path, beta) for beta in BETAS}
    return Study(name, title, series, SMALL_HORIZON_STEPS, interval_points=10, claims=claims)


def large_study(
    name: str,
    title: str,
    series: dict[str, Condition],
    claims: tuple[Claim, ...],
    interval_points: int = 1,
) -> Study:
    """Figures 12 and 15-21: agents on the 100 x 100 arena, over time in 100 time units."""
    return Study(
        name,
        title,
        series,
        LARGE_HORIZON_STEPS,
        time_unit_steps=100,
        interval_points=interval_points,
        claims=claims,
    )


def gains(approach: Approach, path: ObservedPath) -> tuple[Better, ...]:
    """Every beta is better than no imitation."""
    return tuple(Better(one_path(approach, path, beta), SMALL_NO_IMITATION) for beta in BETAS)


def losses(approach: Approach, path: ObservedPath, betas: tuple[float, ...] = BETAS) -> tuple[Better, ...]:
    """Every one of these betas is worse than no imitation, over all reachings of the goal."""
    return tuple(Better(SMALL_NO_IMITATION, one_path(approach, path, beta), whole_run=True) for beta in betas)
