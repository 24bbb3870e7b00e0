"""Does a path still help where it is not the way? An arena twice as wide, a path along it and one across.

`swarm reproduce examples/long_arena.py --out runs/long_arena` runs it and draws the curves.
"""

from __future__ import annotations

from swarm.geometry import Grid, Move
from swarm.gridworld.arena import Arena
from swarm.gridworld.condition import Condition, GivenPaths, NoTeacher
from swarm.learning.memory import ObservedPath
from swarm.paper.study import Study

LONG = Arena("long", Grid(20, 10), (Move.SE,) * 9 + (Move.E,) * 10)
STEPS = 20_000


def condition(name: str, *paths: ObservedPath) -> Condition:
    teacher = GivenPaths(paths) if paths else NoTeacher()
    return Condition(name, LONG, teacher, epsilon=0.3, steps=STEPS, evaluate_every=20)


def figure() -> Study:
    series = {
        "no imitation": condition("alone"),
        "5 x SE": condition("diagonal", ObservedPath((Move.SE,) * 5)),
        "5 x E": condition("along", ObservedPath((Move.E,) * 5)),
        "5 x S": condition("across", ObservedPath((Move.S,) * 5)),
    }
    return Study("long_arena", "Paths in a long arena", series, horizon_steps=STEPS, runs=20)
