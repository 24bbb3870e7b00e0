"""What the server receives at once: the messages of a tick, or of a moment."""

from __future__ import annotations

from functools import cached_property

from swarm.messages.header import Item


class Batch:
    """Messages received by the run's time `t_ns`."""

    def __init__(self, t_ns: int, received: list[Item]) -> None:
        self.t_ns = t_ns
        self._received = received

    @cached_property
    def items(self) -> list[Item]:
        """By key, epoch and sequence: who was quicker does not show. Sorted when first asked for."""
        return sorted(self._received)
