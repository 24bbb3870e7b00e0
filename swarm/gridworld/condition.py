"""What a study compares: one learner's (or pair's) arena, teacher and settings, as data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from swarm.gridworld.arena import Arena
from swarm.learning.controller import QIncrease
from swarm.learning.memory import Approach, ObservedPath


@dataclass(frozen=True)
class NoTeacher:
    """Q-learning without imitation: an empty memory.

    Two `learners` know nothing of each other: what a pair that imitates is compared with.
    """

    learners: int = 1


@dataclass(frozen=True)
class GivenPaths:
    """Paths that are in the memory from the start, and stay."""

    paths: tuple[ObservedPath, ...]


@dataclass(frozen=True)
class CopyExpert:
    """One who follows the arena's expert path for ever (section 2.3.2 a).

    The learner copies `moves` consecutive moves from a random place of that path each time it has reached
    the goal `every` times more: 1000 portions in 100,000 runs; if `copies_at_once`, before its first run too.
    """

    moves: int = 20
    every: int = 100
    copies_at_once: bool = False


@dataclass(frozen=True)
class CopyExperienced:
    """One who learnt without imitation until it had reached the goal `goal_reachings` times (2.3.2 b).

    It goes on learning and exploring, alternately with the learner, which copies the last `moves`
    moves of it every `every` goal reachings of its own and, if `copies_at_once`, before its first run.
    """

    moves: int = 20
    every: int = 100
    goal_reachings: int = 90_000
    copies_at_once: bool = False


@dataclass(frozen=True)
class CopyEachOther:
    """Two learners that start together, step alternately and copy each other (2.3.2 c)."""

    moves: int = 20
    every: int = 100


@dataclass(frozen=True)
class AccessExpert:
    """The expert's best action in the learner's own state, for up to `moves` moves (section 2.4)."""

    moves: int = 20


@dataclass(frozen=True)
class AccessEachOther:
    """Two learners that read each other's best action in their own state (section 2.4)."""

    moves: int = 20


Teacher = (
    NoTeacher | GivenPaths | CopyExpert | CopyExperienced | CopyEachOther | AccessExpert | AccessEachOther
)


class Precision(Enum):
    """Of the stored Q values."""

    DOUBLE = "double"
    SINGLE = "single"


@dataclass(frozen=True)
class Condition:
    """One curve of a figure.

    A run ends after `steps` time steps or when its first learner has reached the goal
    `goal_reachings` times, whichever comes first. The best path is evaluated every `evaluate_every`
    time steps, up to `points` times, and from then on every `later_every` steps, up to `later_points` times.
    """

    name: str
    arena: Arena
    teacher: Teacher
    epsilon: float
    beta: float = 0.5
    approach: Approach = Approach.AVERAGE_Q
    capacity: int = 10
    steps: int | None = None
    goal_reachings: int | None = None
    evaluate_every: int = 1000
    points: int | None = None
    """How many points the figure needs; None for all of `steps`."""
    later_every: int | None = None
    later_points: int = 0
    increase: QIncrease = QIncrease.ASKED
    precision: Precision = Precision.DOUBLE
    checks_last: bool = False
    """Whether the last action of a path undergoes the Q check."""
    counts_luck: bool = True
    """Whether a best path through cells in which nothing has been learnt may arrive."""

    def __post_init__(self) -> None:
        wrong = self._wrong()
        if wrong:
            raise ValueError(f"{self.name}: {wrong}")

    def _wrong(self) -> str | None:
        """What makes the condition impossible, if anything does."""
        if self.steps is None and (self.goal_reachings is None or self.points is None):
            return "give steps, or goal_reachings and the points to evaluate"
        counts = [self.steps, self.goal_reachings, self.evaluate_every, self.points, self.capacity]
        counts += [getattr(self.teacher, field, None) for field in ("moves", "every", "goal_reachings")]
        if any(count is not None and count < 1 for count in counts):
            return "steps, points, capacity and all other counts start at 1"
        if not (0.0 <= self.epsilon <= 1.0 and 0.0 <= self.beta <= 1.0):
            return "epsilon and beta are probabilities, between 0 and 1"
        if isinstance(self.teacher, GivenPaths) and len(self.teacher.paths) > self.capacity:
            return f"{len(self.teacher.paths)} paths do not fit a memory of {self.capacity}"
        path = len(self.arena.expert_path)
        if isinstance(self.teacher, CopyExpert) and self.teacher.moves > path:
            return f"the expert's path has {path} moves, fewer than the {self.teacher.moves} to copy"
        return None

    @property
    def point_limit(self) -> int:
        """How many times the best path is evaluated in a run that uses all of its time steps."""
        if self.steps is None:
            assert self.points is not None
            return self.points
        all_points = self.steps // self.evaluate_every
        return all_points if self.points is None else min(self.points, all_points)

    def evaluated_steps(self, steps: int) -> NDArray[np.int64]:
        """When the best path is evaluated in a run of so many steps (points,)."""
        first = self.evaluate_every * np.arange(1, self.point_limit + 1)
        if self.later_every is None:
            return first[first <= steps]
        last = self.evaluate_every * self.point_limit
        later = last + self.later_every * np.arange(1, self.later_points + 1)
        times = np.concatenate([first, later])
        return times[times <= steps]

    @property
    def imitates(self) -> bool:
        """Whether a learner's memory can hold a path."""
        return not isinstance(self.teacher, NoTeacher)

    @property
    def learners(self) -> int:
        """Whose curves a run yields: two for a pair that teach each other, else one."""
        if isinstance(self.teacher, NoTeacher):
            return self.teacher.learners
        return 2 if isinstance(self.teacher, CopyEachOther | AccessEachOther) else 1
