"""Many rehearsals, each with its own seed, so that one can be repeated by its number."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from robot_agent.rehearsal.drive import demonstrate, expert_moves, random_moves
from robot_agent.rehearsal.stage import Rehearsed, Stage
from swarm.experiment import Experiment
from swarm.geometry import Grid, Move
from swarm.learning.random import spawned_generator

ChooseMoves = Callable[[np.random.Generator, Grid, int], tuple[int, tuple[Move, ...]]]
KINDS: dict[str, ChooseMoves] = {"random": random_moves, "expert": expert_moves}
"""random: any moves that stay in the grid; expert: a part of the shortest path."""


def rehearse(experiment: Experiment, kind: str, number: int, seed: int) -> Rehearsed:
    """Show, watch and copy the demonstration of this number, of as many moves as robots remember."""
    rng = spawned_generator(seed, kind, number, "demonstrator", "rehearsal")
    grid = experiment.compartment(experiment.robot[0]).grid
    start, moves = KINDS[kind](rng, grid, experiment.visits.moves)
    return Stage(experiment, rng).watch(demonstrate(experiment, start, moves, rng))


def rehearsals(experiment: Experiment, kind: str, count: int, seed: int) -> Iterator[Rehearsed]:
    """So many demonstrations of one kind."""
    for number in range(count):
        yield rehearse(experiment, kind, number, seed)
