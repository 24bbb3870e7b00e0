"""One robot's learning as time goes on: its table, its journey, the path that it replays."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

from swarm.analysis.copying.drawing import moves_text
from swarm.analysis.copying.paths import FIRST_R
from swarm.film.recorded_trial import RecordedTrial, Timed
from swarm.geometry import Grid, Move
from swarm.learning.q_table import QTable
from swarm.messages import topics


@dataclass(frozen=True)
class MemoryLine:
    """A remembered path at some time."""

    path: int
    moves: str
    """In words, such as "5 SE"."""
    ratio: float
    """R."""
    replays: int
    is_replayed: bool


class Knowledge:
    """Asked for later and later times only."""

    def __init__(self, trial: RecordedTrial, robot: str) -> None:
        self.moves: Timed = trial.moves(robot)
        self.q = QTable(trial.identity.grid.states)
        self._grid: Grid = trial.identity.grid
        self._times = [t_ns for t_ns, _ in self.moves]
        self._paths = {said.path: tuple(map(Move, said.moves)) for _, said in trial.of(topics.PATH, robot)}
        self._remembered: Timed = trial.of(topics.PATH, robot)
        self._replays: Timed = trial.of(topics.REPLAY, robot)
        self._learnt = 0

    def made(self, t_ns: int) -> int:
        """How many moves had been made by then."""
        return bisect_right(self._times, t_ns)

    def learn_until(self, t_ns: int) -> None:
        """Bring the table to what it was at a time."""
        made = self.made(t_ns)
        for _, move in self.moves[self._learnt : made]:
            self.q.values[move.state][move.action] = move.q_value
        self._learnt = max(self._learnt, made)

    def last(self, t_ns: int) -> Any:
        """The last move by then; None before the first."""
        made = self.made(t_ns)
        return self.moves[made - 1][1] if made else None

    def journey_began_ns(self, t_ns: int) -> int:
        """When the robot set out from the start."""
        made = self.made(t_ns)
        if not made:
            return 0
        track = self.moves[made - 1][1].track
        same = takewhile(lambda each: each[1].track == track, reversed(self.moves[:made]))
        first_ns, first = list(same)[-1]
        return int(first_ns - round(first.duration_s * 1e9))

    def replayed(self, t_ns: int) -> tuple[int, Sequence[int]]:
        """The path that is being replayed, 0 for none, and the cells that it leads through."""
        place = self.made(t_ns)
        number = self.moves[place][1].path if place < len(self.moves) else 0
        if not number or number not in self._paths:
            return 0, ()
        while place and self.moves[place - 1][1].path == number:
            place -= 1
        return number, self._cells(self.moves[place][1].state, self._paths[number])

    def memory(self, t_ns: int) -> list[MemoryLine]:
        """In the order in which the paths came."""
        ended = [replay for ended_ns, replay in self._replays if ended_ns <= t_ns]
        replayed, _ = self.replayed(t_ns)
        known = {said.path: said for said_ns, said in self._remembered if said_ns <= t_ns}
        return [self._line(said, ended, replayed) for said in known.values()]

    def _line(self, said: Any, ended: Sequence[Any], replayed: int) -> MemoryLine:
        ratios = [replay.ratio for replay in ended if replay.path == said.path]
        ratio = ratios[-1] if ratios else FIRST_R
        return MemoryLine(said.path, moves_text(said.moves), ratio, len(ratios), said.path == replayed)

    def _cells(self, state: int, moves: Sequence[Move]) -> list[int]:
        cells = [state]
        for move in moves:
            entered = self._grid.neighbour(cells[-1], move)
            if entered is None:
                break
            cells.append(entered)
        return cells
