"""What one robot has learnt, at any of its moves: its table, its memory, its curve."""

from __future__ import annotations

import heapq
from array import array
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from swarm.geometry import MOVES
from swarm.messages import swarm_pb2 as pb

MOVES_BETWEEN_TABLES = 250
"""A table of 100 states takes 6 kB: half a megabyte in 15,000 moves, and at most 250 updates for any move."""


class MoveMade(NamedTuple):
    """One transition, and when the robot told of it."""

    t_s: float
    number: int
    state: int
    action: int
    next_state: int
    q_value: float
    duration_s: float
    path: int
    """The path that was being replayed, 0 for none."""
    blocked: bool


class RememberedAt(NamedTuple):
    """A path that entered the memory."""

    t_s: float
    number: int
    moves: tuple[int, ...]
    source: str
    visit: int


class ReplayedAt(NamedTuple):
    """A replay that ended, and R afterwards."""

    t_s: float
    path: int
    moves: int
    outcome: str
    q_change: float
    ratio: float
    started_move: int


class BestPathAt(NamedTuple):
    """The greedy path's length after a move."""

    t_s: float
    move: int
    length: int


@dataclass
class PathCounts:
    """A path in the memory at a moment, with the counts of its replays (eq. 2 and 4)."""

    path: RememberedAt
    replayed: int = 0
    completed: int = 0
    improved: int = 0
    ratio: float = 1.0
    ratios: list[tuple[int, float]] = field(default_factory=list)
    """(move, R) after each replay."""

    def add(self, replay: ReplayedAt) -> None:
        self.replayed += 1
        self.completed += replay.outcome == "completed"
        self.improved += replay.q_change > 0
        self.ratio = replay.ratio
        self.ratios.append((replay.started_move + replay.moves - 1, replay.ratio))


class LearningHistory:
    """Everything that a learner said. Counts of moves (`made`) are in the order in which they were heard:
    a robot that went on from a checkpoint may have told of a number twice.
    """

    def __init__(self, states: int, capacity: int) -> None:
        self._capacity = capacity
        self.moves: list[MoveMade] = []
        self.paths: list[RememberedAt] = []
        self.replays: list[ReplayedAt] = []
        self.best_paths: list[BestPathAt] = []
        self._table = array("d", bytes(8 * states * MOVES))
        self._kept: list[tuple[int, array[float]]] = [(0, self._table[:])]
        """(moves made, table) every so many moves, and where a robot went back."""
        self._place_of: list[int] = []
        """Of move 1, 2 and so on: its place in `moves`, for a number that was told twice the later one."""

    @property
    def last_number(self) -> int:
        return self.number(len(self.moves))

    def add_move(self, t_s: float, move: pb.Move) -> None:
        """Moves of no cell of this grid are passed over."""
        cell = move.state * MOVES + move.action
        if move.action >= MOVES or cell >= len(self._table) or move.next_state * MOVES >= len(self._table):
            return
        if move.number <= self.last_number:
            self._go_back_to(move.number - 1)
        del self._place_of[max(0, move.number - 1) :]
        self._place_of += [len(self.moves)] * (move.number - len(self._place_of))
        self._table[cell] = move.q_value
        self.moves.append(
            MoveMade(
                t_s,
                move.number,
                move.state,
                move.action,
                move.next_state,
                move.q_value,
                move.duration_s,
                move.path,
                move.blocked,
            )
        )
        if len(self.moves) % MOVES_BETWEEN_TABLES == 0:
            self._keep()

    def add_path(self, t_s: float, path: pb.PathRemembered) -> None:
        """A path that is told again, by a process that started again, is known already."""
        if any(known.number == path.path for known in self.paths):
            return
        self.paths.append(RememberedAt(t_s, path.path, tuple(path.moves), path.source, path.visit))

    def add_replay(self, t_s: float, replay: pb.Replay) -> None:
        self.replays.append(
            ReplayedAt(
                t_s,
                replay.path,
                replay.moves,
                replay.outcome,
                replay.q_change,
                replay.ratio,
                replay.started_move,
            )
        )

    def add_best_path(self, t_s: float, best: pb.BestPath) -> None:
        self.best_paths.append(BestPathAt(t_s, best.move, best.length))

    def made(self, t_s: float) -> int:
        """How many moves had been told by a time."""
        return bisect_right(self.moves, t_s, key=lambda move: move.t_s)

    def number(self, made: int) -> int:
        """Of the last of so many moves: more than their count if the first ones were not heard."""
        return self.moves[made - 1].number if made else 0

    def time_of_move(self, number: int) -> float | None:
        """When a move was told; None for one that was not."""
        if not 1 <= number <= len(self._place_of):
            return None
        return self.moves[self._place_of[number - 1]].t_s

    def q_table(self, made: int) -> array[float]:
        """Q(state, action), state by state, after so many moves."""
        kept, table = self._kept[bisect_right(self._kept, made, key=lambda entry: entry[0]) - 1]
        table = table[:]
        for move in self.moves[kept:made]:
            table[move.state * MOVES + move.action] = move.q_value
        return table

    def memory(self, t_s: float) -> Iterator[PathCounts]:
        """Every path in the memory at a time, with what its replays had come to.

        As in the learner, a full memory forgets the path with the lowest R, the oldest of equals.
        """
        counts: dict[int, PathCounts] = {}
        events: list[list[RememberedAt | ReplayedAt]] = [[*self.paths], [*self.replays]]
        for event in heapq.merge(*events, key=lambda event: event.t_s):
            if event.t_s > t_s:
                break
            if isinstance(event, ReplayedAt):
                if event.path in counts:
                    counts[event.path].add(event)
                continue
            if len(counts) >= self._capacity:
                del counts[min(counts.values(), key=lambda each: each.ratio).path.number]
            counts[event.number] = PathCounts(event)
        yield from counts.values()

    def _go_back_to(self, number: int) -> None:
        """A process started again: what it learns on is what it had after that move."""
        known = 1 <= number <= len(self._place_of)
        made = self._place_of[number - 1] + 1 if known else 0
        self._table = self.q_table(made)
        self._keep()

    def _keep(self) -> None:
        self._kept.append((len(self.moves), self._table[:]))
