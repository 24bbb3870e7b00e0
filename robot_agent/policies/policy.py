"""What decides in a robot: a learner (algorithm 3) or an expert; the agent's loop knows only this."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from swarm.learning.learner import Transition


class Policy(Protocol):
    """Chooses moves in cells, learns on arrival, and reports what came of each move."""

    @property
    def moves(self) -> int:
        """Moves made so far."""

    @property
    def tracks(self) -> int:
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

    def snapshot(self) -> Mapping[str, object]:
        """Everything that a restarted agent needs to go on, as JSON can hold it."""

    def restore(self, saved: Any) -> None:
        """Go on from a snapshot that went through JSON; ValueError if it does not fit."""
