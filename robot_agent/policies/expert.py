"""The expert of section 3.4.1: it follows the shortest path indefinitely."""

from __future__ import annotations

from typing import Any

from robot_agent.policies.policy import Publish, Transition, shortest_moves
from swarm.geometry import Grid
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics


class Expert:
    """Demonstrates; it has nothing to learn and never finishes."""

    finished = False

    def __init__(self, grid: Grid, publish: Publish) -> None:
        self.moves = 0
        self.tracks = 0
        self._goal = grid.goal
        self._publish = publish
        self._action_in = self._actions(grid)

    @staticmethod
    def _actions(grid: Grid) -> dict[int, int]:
        """The move in each cell of the shortest path."""
        actions, state = {}, grid.start
        for move in shortest_moves(grid):
            actions[state] = int(move)
            entered = grid.neighbour(state, move)
            assert entered is not None
            state = entered
        return actions

    def choose(self, state: int) -> int:
        """The path's move; a robot that was set down beside the path heads for the goal by it."""
        return self._action_in.get(state, min(self._action_in.values()))

    def learn(self, transition: Transition) -> None:
        self.moves += 1
        self._publish(
            topics.MOVE,
            pb.Move(
                number=self.moves,
                track=self.tracks + 1,
                state=transition.state,
                action=transition.action,
                next_state=transition.next_state,
                duration_s=transition.duration_s,
                blocked=transition.blocked,
            ),
        )
        self.tracks += transition.next_state == self._goal

    def abandon(self) -> None:
        """An expert learns nothing from any move."""

    def snapshot(self) -> dict[str, Any]:
        return {"moves": self.moves, "tracks": self.tracks}

    def restore(self, snapshot: dict[str, Any]) -> None:
        self.moves, self.tracks = int(snapshot["moves"]), int(snapshot["tracks"])
