"""The two kinds of study in section 2: one path on the small arena, several agents on the large one."""

from __future__ import annotations

from swarm.experiments.claim import Better
from swarm.experiments.paper.conditions import (
    BETAS,
    LARGE_HORIZON_STEPS,
    SMALL_HORIZON_STEPS,
    SMALL_NO_IMITATION,
    one_path,
)
from swarm.experiments.study import Study
from swarm.gridworld.condition import Condition
from swarm.learning.memory import Approach
from swarm.learning.paths import ObservedPath


def one_path_study(name: str, title: str, approach: Approach, path: ObservedPath) -> Study:
    """Figures 3 and 5-9: the three betas beside no imitation, on the 10 x 10 arena."""
    series = {"no imitation": SMALL_NO_IMITATION}
    series |= {f"β = {beta}": one_path(approach, path, beta) for beta in BETAS}
    return Study(name, title, series, SMALL_HORIZON_STEPS, interval_points=10)


def large_study(name: str, title: str, series: dict[str, Condition], interval_points: int = 1) -> Study:
    """Figures 12 and 15-21: agents on the 100 x 100 arena, over time in 100 time units."""
    return Study(
        name, title, series, LARGE_HORIZON_STEPS, time_unit_steps=100, interval_points=interval_points
    )


def gains(approach: Approach, path: ObservedPath) -> tuple[Better, ...]:
    """Every beta is better than no imitation."""
    return tuple(Better(one_path(approach, path, beta), SMALL_NO_IMITATION) for beta in BETAS)


def losses(approach: Approach, path: ObservedPath, betas: tuple[float, ...] = BETAS) -> tuple[Better, ...]:
    """Every one of these betas is worse than no imitation."""
    return tuple(Better(SMALL_NO_IMITATION, one_path(approach, path, beta)) for beta in betas)
