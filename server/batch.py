"""What the server receives at once: the messages of a tick, or of a moment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class LogItem(NamedTuple):
    """One message with its header, undecoded. Items sort by key, epoch and sequence."""

    key: str
    epoch: int
    sequence: int
    publish_t_ns: int
    payload: bytes


@dataclass(frozen=True, slots=True)
class Batch:
    """Messages received by the run's time `t_ns`."""

    t_ns: int
    items: list[LogItem]
