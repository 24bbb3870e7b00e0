"""Which core each process of a lockstep keeps to.

Every tick wakes every process once, and a wake-up across cores costs more than the work of an agent. A
lockstep whose processes hop between cores runs at half the speed or less.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

SERVER_SHARE = 2
"""The hub and the recorder together use as much time as two robots' processes."""


def available_cores() -> list[int]:
    """The cores that this process may use."""
    return sorted(os.sched_getaffinity(0))


def spread(processes: int, cores: Sequence[int]) -> list[int]:
    """A core for each process: always the one with the least to do, where the server has the first."""
    load = [SERVER_SHARE] + [0] * (len(cores) - 1)
    chosen = []
    for _ in range(processes):
        least = max(range(len(cores)), key=lambda core: (-load[core], core))
        load[least] += 1
        chosen.append(cores[least])
    return chosen


@contextmanager
def keeping_to(core: int) -> Iterator[None]:
    """This thread and those that it starts inside the block keep to a core; afterwards this one is free."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {core})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
