"""How long a trial will still take, by the pace that its slowest learner has kept."""

from __future__ import annotations

from collections.abc import Mapping

from swarm.clock import NS_PER_S


class TimeLeft:
    """Follows a trial's moves over the time in which it was under way: pauses do not count."""

    def __init__(self, moves_wanted: int) -> None:
        self._wanted = moves_wanted
        self._first: dict[str, int] = {}
        """Moves of each learner when it was first looked at: another server may have seen them made."""
        self._under_way_ns = 0
        self._t_ns: int | None = None

    def step(self, moves: Mapping[str, int], t_ns: int, *, under_way: bool) -> None:
        """Time has passed."""
        for learner, made in moves.items():
            self._first.setdefault(learner, made)
        if under_way and self._t_ns is not None:
            self._under_way_ns += t_ns - self._t_ns
        self._t_ns = t_ns

    def left_s(self, moves: Mapping[str, int]) -> float:
        """Seconds of the run's time; 0 while nobody can say, since a learner has made no move yet."""
        made = {learner: count - self._first.get(learner, count) for learner, count in moves.items()}
        if not made or min(made.values()) <= 0:
            return 0.0
        under_way_s = self._under_way_ns / NS_PER_S
        return max(
            under_way_s / made[learner] * max(0, self._wanted - count) for learner, count in moves.items()
        )
