"""The expert of section 3.4.1: it follows the shortest path indefinitely."""

from __future__ import annotations

from typing import TypedDict

from robot_agent.reports import Reporter
from swarm.geometry import Grid
from swarm.learning.expert import expert_move
from swarm.learning.learner import MoveRecord, Transition


class ExpertSnapshot(TypedDict):
    """An expert's counters."""

    moves: int
    tracks: int


class ExpertPolicy:
    """Demonstrates; it has nothing to learn and never finishes."""

    finished = False

    def __init__(self, grid: Grid, reporter: Reporter) -> None:
        self.moves = 0
        self.tracks = 0
        self._grid = grid
        self._reporter = reporter

    def choose(self, state: int) -> int:
        return expert_move(self._grid, state)

    def learn(self, transition: Transition) -> None:
        self.moves += 1
        self._reporter.move(MoveRecord(self.moves, self.tracks + 1, transition))
        self.tracks += transition.next_state == self._grid.goal

    def abandon(self) -> None:
        """An expert learns nothing from any move."""

    def snapshot(self) -> ExpertSnapshot:
        return {"moves": self.moves, "tracks": self.tracks}

    def restore(self, saved: ExpertSnapshot) -> None:
        self.moves, self.tracks = saved["moves"], saved["tracks"]
