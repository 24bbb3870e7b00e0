"""When poses were captured, on the bridge's own clock, whatever the tracking system's clock does."""

from __future__ import annotations

from collections.abc import Callable

from swarm.clock import NS_PER_S
from swarm.runtime.clock_offset import ClockOffset, described
from tracker_bridge.backends.interface import TrackedPose

Report = Callable[[str, str], None]
"""Puts an event, by name and text, into the log."""


class CaptureTimes:
    """Follows the clock of each robot's poses: one wrong time is refused, several agree on a new base.

    Poses are `lateness_s` old when they come, in the run's time, which goes `speed` times as fast as life.
    """

    def __init__(self, report: Report, lateness_s: float, speed: float) -> None:
        self._report = report
        self._lateness_ns = round(lateness_s * NS_PER_S)
        self._speed = speed
        self._clocks: dict[str, ClockOffset] = {}

    def on_own_clock(self, tracked: TrackedPose, t_ns: int) -> TrackedPose | None:
        """The pose with its time on the bridge's clock; None if that time is not to be believed."""
        clock = self._clock_of(tracked.robot)
        before_ns = clock.ns
        captured_t_ns = clock.on_this_clock(tracked.captured_t_ns, t_ns, self._lateness_ns)
        if clock.ns != before_ns:
            text = f"the tracking system's clock is {described(clock.ns)} this one"
            self._report("clock", f"{tracked.robot}: {text}: corrected")
        if captured_t_ns is None or captured_t_ns == tracked.captured_t_ns:
            return None if captured_t_ns is None else tracked
        return tracked._replace(captured_t_ns=captured_t_ns)

    def _clock_of(self, robot: str) -> ClockOffset:
        if robot not in self._clocks:
            self._clocks[robot] = ClockOffset(self._speed, can_step=True)
        return self._clocks[robot]
