"""The learning robot: it reports what its learner makes of every move."""

from __future__ import annotations

from robot_agent.policies.access import AccessedRobot
from robot_agent.reports import Reporter
from swarm.learning.learner import Learner, LearnerSnapshot, Transition
from swarm.learning.memory import ObservedPath


class LearningPolicy:
    """A learner with so many moves to make, and a voice.

    If the experiment permits it (section 2.4), it tells another robot its best moves (`is_accessed`), or
    reads another's (`accessed`) as a path of its memory.
    """

    def __init__(
        self,
        learner: Learner,
        moves_to_make: int,
        reporter: Reporter,
        *,
        is_accessed: bool = False,
        accessed: AccessedRobot | None = None,
    ) -> None:
        self._learner = learner
        self._moves_to_make = moves_to_make
        self._reporter = reporter
        self._is_accessed = is_accessed
        self._accessed = accessed

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
        if self._accessed and self._accessed.first_heard():
            self._reporter.accessed_path(self._learner.remember(self._accessed.path))
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
            if self._is_accessed:
                self._reporter.best_moves(move.number, self._learner.best_moves)

    def abandon(self) -> None:
        self._learner.abandon()

    def snapshot(self) -> LearnerSnapshot:
        return self._learner.snapshot()

    def restore(self, saved: LearnerSnapshot) -> None:
        self._learner.restore(saved)
