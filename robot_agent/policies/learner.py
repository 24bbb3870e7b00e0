"""The learning robot: it reports what its learner makes of every move."""

from __future__ import annotations

from robot_agent.reports import Reporter
from swarm.learning.learner import Learner, LearnerSnapshot, Transition
from swarm.learning.memory import ObservedPath


class LearningPolicy:
    """A learner with so many moves to make, and a voice."""

    def __init__(self, learner: Learner, moves_to_make: int, reporter: Reporter) -> None:
        self._learner = learner
        self._moves_to_make = moves_to_make
        self._reporter = reporter

    @property
    def moves(self) -> int:
        return self._learner.moves

    @property
    def tracks(self) -> int:
        return self._learner.tracks

    @property
    def finished(self) -> bool:
        return self.moves >= self._moves_to_make

    def remember(self, path: ObservedPath, source: str, visit: int = 0) -> int:
        """Algorithm 3's AddNewPath; returns the path's number. `source` is "given" or "camera"."""
        number = self._learner.remember(path)
        self._reporter.path(number, path, source, visit)
        return number

    def choose(self, state: int) -> int:
        choice = self._learner.choose(state)
        if choice.rejected:
            self._reporter.replay(choice.rejected)
        return choice.action

    def learn(self, transition: Transition) -> None:
        move = self._learner.learn(transition)
        self._reporter.move(move)
        if move.ended:
            self._reporter.replay(move.ended)
        if move.best_path_length is not None:
            self._reporter.best_path(move.number, move.best_path_length, self._learner.path_length_cap)

    def abandon(self) -> None:
        self._learner.abandon()

    def snapshot(self) -> LearnerSnapshot:
        return self._learner.snapshot()

    def restore(self, saved: LearnerSnapshot) -> None:
        self._learner.restore(saved)
