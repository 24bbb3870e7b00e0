"""What decides in a robot: a learner (algorithm 3) or an expert; the agent's loop knows only this."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from google.protobuf.message import Message

from swarm.geometry import Grid, Move
from swarm.messages.topics import Topic

Publish = Callable[[Topic[Any], Message], None]
"""Sends a message under the robot's own key."""


@dataclass(frozen=True, slots=True)
class Transition:
    """What came of an action: eq. 7's s, a, s' and t2 - t1."""

    state: int
    action: int
    next_state: int
    duration_s: float
    blocked: bool


class Policy(Protocol):
    """Chooses moves in cells and learns on arrival."""

    moves: int
    """Moves made so far."""
    tracks: int
    """Journeys from the start to the goal that have ended."""

    @property
    def finished(self) -> bool:
        """Whether the experiment's moves are made."""

    def choose(self, state: int) -> int:
        """The move to make from the centre of a cell."""

    def learn(self, transition: Transition) -> None:
        """Take in what came of the last choice, and report it."""

    def abandon(self) -> None:
        """The last choice came to nothing that may be learnt: the robot was carried away."""

    def snapshot(self) -> dict[str, Any]:
        """Everything that a restarted agent needs to go on, as JSON can hold it."""

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot; ValueError if it does not fit."""


def shortest_moves(grid: Grid) -> tuple[Move, ...]:
    """The expert's path from the start to the goal of an open grid: diagonal first, then straight on."""
    diagonal = min(grid.columns, grid.rows) - 1
    straight = Move.E if grid.columns > grid.rows else Move.S
    return (Move.SE,) * diagonal + (straight,) * (max(grid.columns, grid.rows) - 1 - diagonal)
