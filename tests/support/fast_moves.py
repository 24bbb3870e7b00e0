"""A fast model of a move: the very same learner, on durations that the full simulation was seen to take.

A driven move's duration depends on how far the robot turns and whether it drives a cell's side or its
diagonal; it is drawn from the moves of that kind in a log. A blocked move takes what the experiment says.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import numpy as np

from swarm.config.experiment import LearningSettings
from swarm.geometry import MOVES, Grid, Move
from swarm.learning.controller import Controller
from swarm.learning.learner import Learner, Transition
from swarm.learning.memory import ImitationMemory, ObservedPath
from swarm.learning.q_table import QTable
from swarm.learning.random import spawned_generator
from tests.support.swarm_runs import messages

GRID = Grid(10, 10)
HEADING_AT_THE_START = int(Move.E)
HEADING_AFTER_THE_DRIVE_BACK = int(Move.NW)

Kind = tuple[int, int]
"""Turn in eighths of a circle, 0 to 4, and 1 for a diagonal."""


def kind_of(heading: int, action: int) -> Kind:
    """What a move's duration depends on."""
    turn = (action - heading) % MOVES
    return min(turn, MOVES - turn), action % 2


def durations_in(log: Path) -> dict[Kind, list[float]]:
    """The durations in seconds of a log's driven moves, by kind."""
    headings: dict[str, int] = {}
    found: dict[Kind, list[float]] = defaultdict(list)
    for robot, move in messages(log, "move"):
        if move.blocked:
            continue
        found[kind_of(headings.get(robot, HEADING_AT_THE_START), move.action)].append(move.duration_s)
        arrived = move.next_state == GRID.goal
        headings[robot] = HEADING_AFTER_THE_DRIVE_BACK if arrived else move.action
    return dict(found)


class SurrogateRobot:
    """A learner whose moves take no driving."""

    def __init__(
        self,
        durations: dict[Kind, list[float]],
        rules: LearningSettings,
        *,
        given: bool,
        seed: int,
        trial: int,
    ) -> None:
        self.best_paths: dict[int, int] = {}
        """The greedy path's length by move, every ten moves."""
        self.seconds: list[float] = []
        """How long each driven move took."""
        condition = "given" if given else "alone"

        def generator(component: str) -> np.random.Generator:
            return spawned_generator(seed, condition, trial, "fast", component)

        memory = ImitationMemory(rules.beta, rules.approach, rules.capacity)
        controller = Controller(QTable(GRID.states), memory, rules.epsilon, generator("controller"))
        self.learner = Learner(
            GRID, controller, generator("evaluation"), rules.path_length_cap, rules.discount_rate_per_s
        )
        self.q = controller.q
        if given:
            self.learner.remember(ObservedPath((Move.SE,) * 5))
        self._durations = durations
        self._blocked_move_s = rules.blocked_move_s
        self._rng = generator("durations")

    def run(self, moves: int) -> None:
        """So many moves from the start cell, with a drive back from every goal."""
        state, heading = GRID.start, HEADING_AT_THE_START
        for _ in range(moves):
            state, heading = self._move(state, heading)

    def _move(self, state: int, heading: int) -> tuple[int, int]:
        action = self.learner.choose(state).action
        entered = GRID.neighbour(state, action)
        if entered is None:
            self._learn(Transition(state, action, state, self._blocked_move_s, True))
            return state, heading
        duration_s = self._drawn(kind_of(heading, action))
        self._learn(Transition(state, action, entered, duration_s, False))
        self.seconds.append(duration_s)
        return (GRID.start, HEADING_AFTER_THE_DRIVE_BACK) if entered == GRID.goal else (entered, action)

    def _drawn(self, kind: Kind) -> float:
        seen = self._durations[kind]
        return seen[int(self._rng.integers(len(seen)))]

    def _learn(self, transition: Transition) -> None:
        move = self.learner.learn(transition)
        if move.best_path_length is not None:
            self.best_paths[move.number] = move.best_path_length
