"""Shows a swarm to an emulator, frame after frame."""

from __future__ import annotations

from swarm.clock import NS_PER_S, WallClock
from tracker_bridge.backends.interface import Backend
from tracker_bridge.emulators.interface import Emulator


def serve(emulator: Emulator, motion: Backend, clock: WallClock, period_s: float, seconds: float) -> None:
    """For so many seconds, or without end if 0. A frame has each robot once, where it was last."""
    end_ns = clock.now_ns() + round(seconds * NS_PER_S)
    for t_ns in clock.ticks(period_s):
        newest = {tracked.robot: tracked for tracked in motion.poses(t_ns)}
        emulator.show(newest.values(), t_ns)
        if seconds and t_ns >= end_ns:
            return
