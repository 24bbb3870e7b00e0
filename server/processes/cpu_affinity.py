"""Which core each process of a lockstep keeps to, and how it shares the core with the others.

Every exchange wakes every process once, and a wake-up across cores costs more than the work of an agent. A
lockstep whose processes hop between cores runs at half the speed or less. A process that is woken also
waits until the one at work rests (SCHED_BATCH): else nearly every message interrupts somebody.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from enum import Enum
from pathlib import Path

SERVER_SHARE = 2
"""The hub and the recorder together use as much time as two robots' processes."""


CAN_CHOOSE = hasattr(os, "sched_setaffinity")
"""Linux can; elsewhere a lockstep runs as the system likes, and slower."""


def keep(pid: int, core: int) -> None:
    """A process keeps to a core from now on."""
    if CAN_CHOOSE:
        os.sched_setaffinity(pid, {core})


class Placement(Enum):
    """Where and when the processes of a lockstep run."""

    KEPT = "kept"
    """Each on its core, interrupting nobody there."""
    FREE = "free"
    """Wherever and whenever the system likes."""

    @property
    def other(self) -> Placement:
        return Placement.FREE if self is Placement.KEPT else Placement.KEPT


def place(core_of: Mapping[int, int], cores: Collection[int], placement: Placement) -> None:
    """Put every thread of these processes (by id) on its process's core, or on any of the cores."""
    if not CAN_CHOOSE:
        return
    for pid, core in core_of.items():
        if placement is Placement.KEPT:
            _schedule(pid, {core}, os.SCHED_BATCH)
        else:
            _schedule(pid, cores, os.SCHED_OTHER)


def _schedule(pid: int, cores: Collection[int], policy: int) -> None:
    """A thread or a process that has ended meanwhile is passed over."""
    with suppress(FileNotFoundError, ProcessLookupError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            with suppress(ProcessLookupError):
                os.sched_setaffinity(int(task.name), cores)
                os.sched_setscheduler(int(task.name), policy, os.sched_param(0))


def spread(processes: int, cores: Sequence[int]) -> list[int]:
    """A core for each process: always the one with the least to do, where the server has the first.

    The processes beside the server come last: told of a tick in this order, the others start meanwhile.
    """
    load = [SERVER_SHARE] + [0] * (len(cores) - 1)
    chosen = []
    for _ in range(processes):
        least = max(range(len(cores)), key=lambda core: (-load[core], core))
        load[least] += 1
        chosen.append(cores[least])
    return sorted(chosen, reverse=True)


@contextmanager
def keeping_to_share(number: int, shares: int) -> Iterator[None]:
    """Inside the block this thread and what it starts keep to their share of the cores, by its number.

    Of two locksteps side by side each is half as fast again on cores of its own as on all of them.
    """
    if not CAN_CHOOSE:
        yield
        return
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, share(sorted(cores), number, shares))
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def share(cores: Sequence[int], number: int, shares: int) -> list[int]:
    """Every `shares`-th core, or where there are more shares than cores one of them."""
    first = number % min(shares, len(cores))
    return list(cores[first::shares])


@contextmanager
def keeping_to(core: int) -> Iterator[None]:
    """This thread and what it starts inside the block keep to a core and interrupt nobody there.

    Processes that are started inside inherit both; afterwards this thread is as it was.
    """
    if not CAN_CHOOSE:
        yield
        return
    cores, policy, parameters = os.sched_getaffinity(0), os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setaffinity(0, {core})
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    try:
        yield
    finally:
        os.sched_setscheduler(0, policy, parameters)
        os.sched_setaffinity(0, cores)
