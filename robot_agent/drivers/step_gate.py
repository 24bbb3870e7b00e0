"""Takes readings of two 16-bit step counters and lets only those through that wheels can have made."""

from __future__ import annotations

from robot_agent.drivers.body import WheelSteps
from robot_agent.drivers.robot_link import wrapped_difference

FASTEST_STEPS_PER_S = 1250.0
"""Above the 1111 steps/s of an e-puck2's motors by the error of the time between two readings."""
SLACK_STEPS = 40
"""What the moment of a reading is uncertain by, 30 ms, at full speed."""


class StepGate:
    """Unwraps the counters. A reading further away than the wheels can have turned is refused.

    When the next reading agrees with the refused one, the counters were set anew (the robot was reset):
    the counts go on from where they were, and what was driven in between is lost.
    """

    def __init__(self) -> None:
        self.refused = 0
        """Readings refused so far."""
        self._last: tuple[int, int, int] | None = None
        self._doubtful: tuple[int, int, int] | None = None
        self._left = self._right = 0

    def take(self, left: int, right: int, t_ns: int) -> bool:
        """Whether the reading was let through."""
        reading = (left, right, t_ns)
        if self._last is None:
            self._left, self._right = left, right
        elif _is_reachable(self._last, reading):
            self._left += wrapped_difference(left, self._last[0])
            self._right += wrapped_difference(right, self._last[1])
        elif self._doubtful is None or not _is_reachable(self._doubtful, reading):
            self._doubtful = reading
            self.refused += 1
            return False
        self._last, self._doubtful = reading, None
        return True

    @property
    def steps(self) -> WheelSteps:
        """The counts after the last good reading."""
        return WheelSteps(self._left, self._right)


def _is_reachable(before: tuple[int, int, int], after: tuple[int, int, int]) -> bool:
    reach = SLACK_STEPS + FASTEST_STEPS_PER_S * (after[2] - before[2]) * 1e-9
    return all(abs(wrapped_difference(after[wheel], before[wheel])) <= reach for wheel in (0, 1))
