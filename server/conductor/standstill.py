"""Robots that stand for ever: looked for one by one, since the others may well go on."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from swarm.clock import NS_PER_S
from swarm.config.experiment import Experiment

STANDS_S = 600.0
"""Beyond what the experiment itself asks for: a simulated tracker may lose a robot for a while."""
SLOWEST_M_PER_S = 0.05
"""Half of the speed at which robots drive."""


class Standstill:
    """How long each robot has made no move."""

    def __init__(self, experiment: Experiment) -> None:
        self._learners = {robot.id for robot in experiment.learners}
        self._moves_wanted = experiment.run.moves
        self._limit_ns = round(longest_rest_s(experiment) * NS_PER_S)
        self._moved_ns: dict[str, int] = {}

    @property
    def limit_s(self) -> float:
        """A robot that makes no move for so long stands for ever."""
        return self._limit_ns / NS_PER_S

    def moved(self, robot: str, t_ns: int) -> None:
        """A robot has made a move."""
        self._moved_ns[robot] = t_ns

    def excused(self, robots: Iterable[str], t_ns: int) -> None:
        """Robots that stand because somebody wants them to."""
        for robot in robots:
            self.moved(robot, t_ns)

    def standing(self, moves: Mapping[str, int], t_ns: int) -> list[str]:
        """The robots that have moves to make, and made none for too long. It counts from the first call."""
        return [
            robot
            for robot, made in moves.items()
            if t_ns - self._moved_ns.setdefault(robot, t_ns) > self._limit_ns
            and not (robot in self._learners and made >= self._moves_wanted)
        ]


def longest_rest_s(experiment: Experiment) -> float:
    """What may lie between two moves: a visit, rests at goal and start, a drive across, and some patience."""
    arena, learning = experiment.arena, experiment.learning
    across_m = arena.cell_m * math.hypot(arena.columns, arena.rows)
    asked_for_s = experiment.visits.duration_s + 2 * learning.rest_s + learning.blocked_move_s
    return STANDS_S + asked_for_s + across_m / SLOWEST_M_PER_S
