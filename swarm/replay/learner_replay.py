"""Feeds a robot's recorded transitions to the one learner, and compares whatever it says.

The learner's random numbers come from the experiment's seed, so a replay needs nothing but the log. It stops
at the first decision that differs: what was observed from there on belongs to another decision.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, combinations, islice
from typing import Any

from swarm.errors import UserError
from swarm.geometry import Move
from swarm.learning.learner import Choice, Learner, LearnerSnapshot, MoveRecord, Transition
from swarm.learning.memory import ObservedPath
from swarm.learning.q_table import QTable
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.replay.comparison import Difference, is_same, move_differences, recorded_replay, told
from swarm.replay.recorded import RecordedLearning, Said

ACCESS = "access"
"""Of a path whose moves another robot's internal state decides."""
GIVEN = "given"
"""Of a path that every start of a robot's process has from the experiment, whatever is in the log."""
MOST_DISPLACED = 6
"""Between two moves: each may have ended a move or not, which makes at most 64 cases to try."""
MOST_FORKS = 1000
"""That are gone back to in a log: a wrong case shows after some ten moves, so that this takes a second."""

GivenUp = tuple[Said, ...]
"""The times that a robot was carried away in the middle of a move."""


@dataclass(frozen=True)
class Fork:
    """A place in the log that may be read in several ways, and all that is needed to go back to it."""

    place: int
    cases: Iterator[GivenUp]
    """Those that were not tried."""
    epoch: int | None
    learner: LearnerSnapshot
    first: Difference | None
    recorded_q: list[list[float]]
    replays: deque[Any]
    best_paths: deque[Any]


@dataclass(frozen=True)
class Trial:
    """What a learner says when it is asked for a move, given which of the moves before came to nothing."""

    choice: Choice
    rejected: list[dict[str, Any] | None]
    """Every replay that the Q check rejected meanwhile."""
    path: int
    """The path that the chosen action belongs to; 0 for none."""


class LearnerReplay:
    """One robot's learning once more; `without` are the numbers of paths that it is not to remember."""

    def __init__(
        self,
        learner: Learner,
        given: Iterable[ObservedPath],
        recorded: RecordedLearning,
        without: Collection[int] = (),
        given_up: Mapping[int, GivenUp] | None = None,
    ) -> None:
        self.learner = learner
        self.first: Difference | None = None
        """What differs first."""
        self.diverged: Difference | None = None
        """The first decision that differs, or a move that the log lacks: nothing after it can be replayed."""
        self.q_values_that_differ: int | None = None
        """Of the final table against the recorded values; None if the replay did not come to the end."""
        self.given_up: dict[int, GivenUp] = dict(given_up or {})
        """How the log was read where it may be read in several ways; what is given is not asked again."""
        self._recorded = recorded
        self._without = without
        for path in given:
            self._remember(path)
        self._epoch: int | None = None
        self._saved: dict[int, LearnerSnapshot] = {0: learner.snapshot()}
        """After so many moves, where a later start of the robot's process went on from."""
        self._resumed_after = {number - 1 for number in recorded.first_moves().values()}
        self._recorded_q = QTable(len(learner.controller.q.values))
        self._replays: deque[Any] = deque()
        self._best_paths: deque[Any] = deque()
        self._forks: list[Fork] = []
        self._gone_back = 0
        self._ends: list[tuple[Difference, Difference | None]] = []
        """Of each reading that was tried: where it diverged, and what differed first."""

    def run(self, at: int | None = None) -> LearnerSnapshot | None:
        """To the end, or to the first decision that differs; the learner as it was after `at` moves."""
        steps, place, then = self._recorded.steps(), 0, None
        while place < len(steps) and not self.diverged:
            self._step(place, *steps[place])
            if self.learner.moves == at and not self.diverged:
                then = self.learner.snapshot()
            place = self._other_reading(place) if self.diverged else place + 1
        if not self.diverged:
            self._check_left_over()
            self.q_values_that_differ = self._q_values_that_differ()
        return then

    @property
    def moves(self) -> int:
        """How many were compared."""
        return self.diverged.move - 1 if self.diverged else self.learner.moves

    def _step(self, place: int, between: Sequence[Said], said: Said) -> None:
        """Ask for a move, compare, tell what came of it, compare again."""
        recorded = said.message
        if said.epoch != self._epoch:
            self._start(said.epoch, recorded.number)
        between = [each for each in between if each.epoch == said.epoch]
        self._note(self._difference_of_choice(recorded, between, self._reading_of(place, between)))
        if self.diverged:
            return
        made = self.learner.learn(_transition(recorded))
        self._recorded_q.values[recorded.state][recorded.action] = recorded.q_value
        for found in self._differences_of_result(recorded, made):
            self._note(found)
        if self.learner.moves in self._resumed_after:
            self._saved[self.learner.moves] = self.learner.snapshot()

    def _reading_of(self, place: int, between: Sequence[Said]) -> GivenUp:
        """Where a robot was carried away, the log does not say whether it was making a move. What it decided
        from there on does: each case is tried until it leads to a decision that was not made. Of a robot that
        was stopped at once the log does say it.
        """
        if place not in self.given_up:
            stopped = tuple(said for said in between if stopped_in(said) is not None)
            places = [said for said in between if displaced_from(said) is not None][:MOST_DISPLACED]
            if not places:
                return stopped
            chosen = chain.from_iterable(combinations(places, size) for size in range(len(places) + 1))
            cases = (stopped + case for case in chosen)
            self._forks.append(self._fork(place, cases))
            self.given_up[place] = next(cases)
        return self.given_up[place]

    def _fork(self, place: int, cases: Iterator[GivenUp]) -> Fork:
        return Fork(
            place,
            cases,
            self._epoch,
            self.learner.snapshot(),
            self.first,
            self._recorded_q.snapshot(),
            self._replays.copy(),
            self._best_paths.copy(),
        )

    def _other_reading(self, place: int) -> int:
        """Where to go on after a divergence: at the last place that may be read otherwise. If there is none,
        the replay stays where it is, and ends as the reading that led furthest.
        """
        assert self.diverged is not None
        self._ends.append((self.diverged, self.first))
        if self._goes_back():
            self.diverged = None
            return self._forks[-1].place
        self.diverged, self.first = max(self._ends, key=lambda end: end[0].move)
        return place

    def _goes_back(self) -> bool:
        """To the last place with a case that was not tried, if there is one."""
        while self._forks and self._gone_back < MOST_FORKS:
            fork = self._forks[-1]
            case = next(fork.cases, None)
            if case is not None:
                self._gone_back += 1
                self._go_back_to(fork, case)
                return True
            del self.given_up[self._forks.pop().place]
        return False

    def _go_back_to(self, fork: Fork, case: GivenUp) -> None:
        self.given_up[fork.place] = case
        self._epoch = fork.epoch
        self.learner.restore(fork.learner)
        self.first = fork.first
        self._recorded_q.restore(fork.recorded_q)
        self._replays, self._best_paths = fork.replays.copy(), fork.best_paths.copy()

    def _note(self, found: Difference | None) -> None:
        self.first = self.first or found
        if found and found.ends_replay:
            self.diverged = found

    def _start(self, epoch: int, first_move: int) -> None:
        """A process has started: it goes on from its checkpoint, or anew. What the one before said last
        may have come of a move that was never made.
        """
        self._epoch = epoch
        if first_move - 1 in self._saved:
            self.learner.restore(self._saved[first_move - 1])
        if first_move == 1:
            self._recorded_q = QTable(len(self._recorded_q.values))
        self._replays = deque(self._recorded.results[topics.REPLAY, epoch])
        self._best_paths = deque(self._recorded.results[topics.BEST_PATH, epoch])

    def _difference_of_choice(
        self, recorded: pb.Move, between: Sequence[Said], given_up: GivenUp
    ) -> Difference | None:
        if recorded.number != self.learner.moves + 1:
            return Difference(self.learner.moves + 1, "number", recorded.number, self.learner.moves + 1)
        trial = self._trial(recorded.state, between, given_up)
        number, action = recorded.number, trial.choice.action
        expected = [recorded_replay(message) for message in islice(self._replays, len(trial.rejected))]
        for _ in expected:
            self._replays.popleft()
        if recorded.action != action:
            return Difference(number, "action", Move(recorded.action).name, Move(action).name)
        if recorded.path != trial.path:
            return Difference(number, "path", recorded.path, trial.path)
        if not is_same(expected, trial.rejected):
            return Difference(number, "rejected replay", expected, trial.rejected)
        return None

    def _trial(self, state: int, between: Iterable[Said], given_up: GivenUp) -> Trial:
        choices = []
        for said in between:
            self._take(said.message)
            if said in given_up:
                choices.append(self.learner.choose(displaced_from(said) or stopped_in(said) or 0))
                self.learner.abandon()
        choices.append(self.learner.choose(state))
        rejected = [told(choice.rejected) for choice in choices if choice.rejected]
        replay = self.learner.controller.replay
        return Trial(choices[-1], rejected, replay.remembered.number if replay else 0)

    def _take(self, message: Any) -> None:
        """What happens to a learner between its moves."""
        if isinstance(message, pb.Visit) and message.phase == pb.Visit.READY:
            self.learner.abandon()
        elif isinstance(message, pb.PathRemembered) and message.source == ACCESS:
            raise UserError("a robot that accesses another's internal state cannot be replayed")
        elif isinstance(message, pb.PathRemembered) and message.source != GIVEN:
            self._remember(ObservedPath(tuple(map(Move, message.moves))))

    def _remember(self, path: ObservedPath) -> None:
        """A path that is left out keeps its number, or those after it would get others."""
        memory = self.learner.controller.memory
        if memory.observed + 1 in self._without:
            memory.observed += 1
        else:
            self.learner.remember(path)

    def _differences_of_result(self, recorded: pb.Move, made: MoveRecord) -> Iterable[Difference]:
        yield from move_differences(recorded, made)
        if made.ended:
            expected = recorded_replay(self._replays.popleft() if self._replays else None)
            if not is_same(expected, told(made.ended)):
                yield Difference(made.number, "ended replay", expected, told(made.ended))
        if made.best_path_length is not None:
            best = self._best_paths.popleft() if self._best_paths else None
            expected_length = best.length if best and best.move == made.number else None
            if not is_same(expected_length, made.best_path_length):
                yield Difference(made.number, "best path", expected_length, made.best_path_length)

    def _check_left_over(self) -> None:
        """The end of a replay that was recorded, and that did not come. The last may be of no move."""
        for message in self._replays:
            if message.started_move + message.moves <= self.learner.moves:
                self._note(Difference(self.learner.moves, "ended replay", recorded_replay(message), None))

    def _q_values_that_differ(self) -> int:
        rows = zip(self._recorded_q.values, self.learner.controller.q.values, strict=True)
        return sum(not is_same(theirs, ours) for row in rows for theirs, ours in zip(*row, strict=True))


def _transition(recorded: pb.Move) -> Transition:
    return Transition(
        recorded.state, recorded.action, recorded.next_state, recorded.duration_s, recorded.blocked
    )


def displaced_from(said: Said) -> int | None:
    """The cell that a robot was standing in or leaving when it was carried away, by its event."""
    return _cell_of(said, ("displaced",))


def stopped_in(said: Said) -> int | None:
    """The cell that a robot was leaving when it gave up its move for an emergency or a lost server."""
    return _cell_of(said, ("estop", "server_lost"))


def _cell_of(said: Said, names: tuple[str, ...]) -> int | None:
    message = said.message
    if not isinstance(message, pb.Event) or message.name not in names:
        return None
    cell = re.search(r"from cell (\d+)", message.text)
    return int(cell[1]) if cell else None
