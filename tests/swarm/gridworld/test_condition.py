"""A condition says at once what is wrong with it."""

from __future__ import annotations

import pytest

from swarm.geometry import Move
from swarm.gridworld.arena import OPEN_10
from swarm.gridworld.condition import Condition, CopyEachOther, CopyExpert, GivenPaths, NoTeacher
from swarm.learning.memory import ObservedPath


def test_points_follow_from_steps() -> None:
    assert Condition("c", OPEN_10, NoTeacher(), 0.3, steps=5_500, evaluate_every=1000).point_limit == 5
    assert (
        Condition("c", OPEN_10, NoTeacher(), 0.3, steps=5_000, evaluate_every=10, points=40).point_limit == 40
    )


def test_pair_has_two_learners() -> None:
    assert Condition("c", OPEN_10, CopyEachOther(moves=4), 0.3, steps=10).learners == 2
    assert Condition("c", OPEN_10, CopyExpert(moves=4), 0.3, steps=10).learners == 1


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"steps": None}, "give steps"),
        ({"steps": None, "goal_reachings": 10}, "points"),
        ({"steps": 0}, "start at 1"),
        ({"capacity": 0}, "start at 1"),
        ({"epsilon": 1.5}, "probabilities"),
        ({"beta": -0.1}, "probabilities"),
        ({"teacher": GivenPaths((ObservedPath((Move.E,)),) * 11)}, "do not fit"),
        ({"teacher": CopyExpert(moves=10)}, "expert's path has 9 moves"),
        ({"teacher": CopyEachOther(moves=4, every=0)}, "start at 1"),
    ],
)
def test_impossible_conditions_are_refused(changes: dict[str, object], says: str) -> None:
    settings: dict[str, object] = {"teacher": NoTeacher(), "epsilon": 0.3, "steps": 100} | changes
    with pytest.raises(ValueError, match=says):
        Condition("c", OPEN_10, **settings)  # type: ignore[arg-type]
