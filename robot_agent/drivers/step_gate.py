"""Takes readings of two 16-bit step counters and lets only those through that wheels can have made."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from robot_agent.drivers.kinematics import WheelSteps
from robot_agent.drivers.robot_link import wrapped_difference

FASTEST_STEPS_PER_S = 1250.0
"""Above the 1111 steps/s of an e-puck2's motors by the error of the time between two readings."""
SLACK_STEPS = 40
"""What the moment of a reading is uncertain by, 30 ms, at full speed."""
READINGS_REMEMBERED = 4
"""A wrong reading that was possible shows when the next ones fit those before it and not itself."""


class CounterReading(NamedTuple):
    """Both counters at a time, and the counts that they stood for."""

    left: int
    right: int
    t_ns: int
    steps: WheelSteps

    def reaches(self, left: int, right: int, t_ns: int) -> bool:
        """Whether wheels can have gone on from here to another reading."""
        reach = SLACK_STEPS + FASTEST_STEPS_PER_S * (t_ns - self.t_ns) * 1e-9
        moved = wrapped_difference(left, self.left), wrapped_difference(right, self.right)
        return max(map(abs, moved)) <= reach

    def followed_by(self, left: int, right: int, t_ns: int) -> CounterReading:
        """A later reading, unwrapped."""
        steps = WheelSteps(
            self.steps.left + wrapped_difference(left, self.left),
            self.steps.right + wrapped_difference(right, self.right),
        )
        return CounterReading(left, right, t_ns, steps)


class StepGate:
    """Unwraps the counters. A reading further away than the wheels can have turned is refused at first.

    When the next one agrees with it, one of those let through before was wrong, and the counts go on from the
    newest that both fit. If they fit none, the counters were set anew (the robot was reset): the counts go on
    from where they were, and what was driven in between is lost.
    """

    def __init__(self) -> None:
        self.refused = 0
        """Readings refused so far."""
        self._good: deque[CounterReading] = deque(maxlen=READINGS_REMEMBERED)
        self._doubtful: CounterReading | None = None

    def take(self, left: int, right: int, t_ns: int) -> bool:
        """Whether the reading was let through."""
        before = self._before(left, right, t_ns)
        if before is None:
            self._doubtful = CounterReading(left, right, t_ns, self.steps)
            self.refused += 1
            return False
        self._good.append(before.followed_by(left, right, t_ns))
        self._doubtful = None
        return True

    def _before(self, left: int, right: int, t_ns: int) -> CounterReading | None:
        """The reading from which the counts go on; None if this one is to be refused."""
        if not self._good:
            return CounterReading(left, right, t_ns, WheelSteps(left, right))
        if self._good[-1].reaches(left, right, t_ns):
            return self._good[-1]
        if self._doubtful is None or not self._doubtful.reaches(left, right, t_ns):
            return None
        fitting = (good for good in reversed(self._good) if good.reaches(left, right, t_ns))
        return next(fitting, self._doubtful)

    @property
    def steps(self) -> WheelSteps:
        """The counts after the last good reading."""
        return self._good[-1].steps if self._good else WheelSteps(0, 0)
