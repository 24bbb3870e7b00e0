"""One trial of an experiment with fast robots: who moves next, who visits whom, and what is copied."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from swarm.config.experiment import Experiment
from swarm.geometry import Move
from swarm.learning.expert import Plan, expert_move
from swarm.learning.memory import ObservedPath, choose_window
from swarm.surrogate.copies import Copies
from swarm.surrogate.durations import HEADING_AT_THE_START, Durations
from swarm.surrogate.robots import ShownMoves, SurrogateLearner, SurrogateRobot, surrogate_robot

CARRIED_S = 2.5
"""To the observer's place and back, in simulation: the tracker has to confirm that the robot stands there."""


@dataclass(frozen=True)
class CopiedPath:
    """A path that entered a memory: whose, after how many moves, what was shown and what was copied."""

    robot: str
    move: int
    true: tuple[Move, ...]
    copied: tuple[Move, ...]

    @property
    def perfect(self) -> bool:
        return self.true == self.copied


@dataclass(frozen=True)
class EnactedPath:
    """A copied path at the end of a trial: how often it was replayed, and its R (eq. 4)."""

    path: CopiedPath
    enacted: int
    ratio: float


@dataclass(frozen=True)
class TrialOutcome:
    """What one trial came to."""

    trial: int
    best_paths: dict[str, list[int]]
    """Learner -> best path length after every ten moves."""
    copies: tuple[CopiedPath, ...]
    learnt_paths: dict[str, list[int]] = field(default_factory=dict)
    """The same as `best_paths`; one that passes a cell in which nothing has been learnt has not arrived."""
    memories: dict[str, tuple[EnactedPath, ...]] = field(default_factory=dict)
    """Learner -> its copied paths, in the order in which they were copied."""


class RobotTrial:
    """Steps whichever robot is behind in time, so that all live in one time."""

    def __init__(
        self,
        experiment: Experiment,
        durations: Durations,
        copies: Copies,
        trial: int,
        plan: Plan = expert_move,
    ) -> None:
        self._experiment, self._copies, self._trial = experiment, copies, trial
        self._robots = {
            each.id: surrogate_robot(experiment, each, durations, trial, plan) for each in experiment.robot
        }
        self._watched_until_s = dict.fromkeys(self._robots, 0.0)
        self._due: dict[str, float] = {}
        """Observers at their places: when each visit ends."""
        self._copied: list[CopiedPath] = []

    def run(self) -> TrialOutcome:
        """Until every learner has made the experiment's moves."""
        learners = [each for each in self._robots.values() if isinstance(each, SurrogateLearner)]
        while self._under_way(learners):
            self._step(min(self._active(learners), key=lambda each: each.t_s))
        best_paths = {each.settings.id: each.best_paths for each in learners}
        learnt_paths = {each.settings.id: each.learnt_paths for each in learners}
        memories = {each.settings.id: self._memory(each) for each in learners}
        return TrialOutcome(self._trial, best_paths, tuple(self._copied), learnt_paths, memories)

    def _memory(self, robot: SurrogateLearner) -> tuple[EnactedPath, ...]:
        """A robot's memory forgets nothing: its paths are those that it copied, after those it was given."""
        copied = [path for path in self._copied if path.robot == robot.settings.id]
        remembered = robot.memory.remembered[len(robot.settings.given_paths()) :]
        return tuple(
            EnactedPath(path, each.n_replicated, robot.memory.ratio(each))
            for path, each in zip(copied, remembered, strict=True)
        )

    def _under_way(self, learners: list[SurrogateLearner]) -> bool:
        return any(each.moves < self._experiment.run.moves for each in learners)

    def _active(self, learners: list[SurrogateLearner]) -> list[SurrogateRobot]:
        """Who still has something to do: an expert as long as somebody may watch it."""
        moves = self._experiment.run.moves
        wanted = {each.settings.watches for each in learners if each.moves < moves and not each.memory.full}
        return [
            each
            for each in self._robots.values()
            if each.settings.id in wanted or (isinstance(each, SurrogateLearner) and each.moves < moves)
        ]

    def _step(self, robot: SurrogateRobot) -> None:
        if not isinstance(robot, SurrogateLearner):
            robot.move()
        elif robot.settings.id in self._due:
            self._end_visit(robot)
        elif self._may_visit(robot):
            self._begin_visit(robot)
        else:
            robot.move()

    def _may_visit(self, robot: SurrogateLearner) -> bool:
        """The conductor's rule: at the start and every so many tracks, until the memory is full."""
        watches = robot.settings.watches
        if not watches or robot.memory.full:
            return False
        due = robot.tracks >= robot.visits * self._experiment.visits.every_tracks
        is_taken = max(self._watched_until_s[watches], self._watched_until_s[robot.settings.id]) > robot.t_s
        return due and not is_taken and watches not in self._due

    def _begin_visit(self, robot: SurrogateLearner) -> None:
        robot.visits += 1
        robot.learner.abandon()
        ends_s = robot.t_s + self._experiment.visits.duration_s + CARRIED_S
        self._due[robot.settings.id] = self._watched_until_s[robot.settings.watches] = ends_s
        robot.t_s = ends_s

    def _end_visit(self, robot: SurrogateLearner) -> None:
        """The demonstrator has caught up with the end of the visit by now: see what it did."""
        ends_s = self._due.pop(robot.settings.id)
        began_s = ends_s - self._experiment.visits.duration_s - CARRIED_S / 2
        seen = longest_drive(self._robots[robot.settings.watches].shown, began_s, ends_s - CARRIED_S / 2)
        true = choose_window(seen, self._experiment.visits.moves, robot.copy_rng)
        copied = self._copies.drawn(true, robot.copy_rng) if true else ()
        if copied:
            robot.learner.remember(ObservedPath(copied))
            self._copied.append(CopiedPath(robot.settings.id, robot.moves, true, copied))
        robot.begin_at_start(HEADING_AT_THE_START)


def longest_drive(shown: Iterable[ShownMoves], began_s: float, ended_s: float) -> tuple[Move, ...]:
    """The moves that were wholly seen between two times; of several journeys, those of the longest part."""
    parts: dict[int, list[Move]] = {}
    for move in shown:
        if began_s <= move.began_s and move.ended_s <= ended_s:
            parts.setdefault(move.track, []).append(move.move)
    longest: list[Move] = max(parts.values(), key=lambda part: len(part), default=[])
    return tuple(longest)
