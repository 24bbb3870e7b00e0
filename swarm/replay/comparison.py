"""What a replayed learner says, held against what was recorded: to the last bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from swarm.learning.learner import MoveRecord, ReplayRecord

ENDS_REPLAY = ("action", "path", "number")
"""What was decided, or a move that the log lacks. Everything else is what came of a decision."""


@dataclass(frozen=True)
class Difference:
    """Where the replay first leaves the record."""

    move: int
    what: str
    recorded: Any
    replayed: Any

    @property
    def ends_replay(self) -> bool:
        """Whether what was observed from here on belongs to something else than was decided here."""
        return self.what in ENDS_REPLAY

    def __str__(self) -> str:
        return f"move {self.move}, {self.what}: recorded {self.recorded}, replayed {self.replayed}"


def is_same(recorded: object, replayed: object) -> bool:
    """Also of numbers every bit: 0.0 is not -0.0, and the shortest text of a float names no other one."""
    return repr(recorded) == repr(replayed)


def move_differences(recorded: Any, replayed: MoveRecord) -> Iterator[Difference]:
    """Of a recorded `Move` message."""
    for what in ("track", "reward", "q_value", "q_change"):
        theirs, ours = getattr(recorded, what), getattr(replayed, what)
        if not is_same(theirs, ours):
            yield Difference(replayed.number, what, theirs, ours)


def told(replay: ReplayRecord | None) -> dict[str, Any] | None:
    """A replay that has ended, as a `Replay` message has it."""
    if replay is None:
        return None
    return {
        "path": replay.path,
        "moves": replay.moves,
        "outcome": replay.outcome.value,
        "q_change": replay.q_change,
        "ratio": replay.ratio,
        "started_move": replay.started_move,
    }


def recorded_replay(message: Any) -> dict[str, Any] | None:
    """The same of a recorded message; None if there is none."""
    names = ("path", "moves", "outcome", "q_change", "ratio", "started_move")
    return {name: getattr(message, name) for name in names} if message else None
