"""Dead reckoning from wheel steps, with a short memory of where the robot was when."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSteps


class Reckoned(NamedTuple):
    """A dead-reckoned state: the pose in the frame in which the robot started, and what each wheel rolled."""

    t_ns: int
    x_m: float
    y_m: float
    theta_rad: float
    left_m: float
    right_m: float


class Odometry:
    """Integrates wheel steps along exact arcs and remembers the states of the last `memory_s` seconds.

    `left_scale` and `right_scale` multiply the nominal length of a step; they may be corrected on the way.
    """

    def __init__(self, geometry: EpuckGeometry, memory_s: float) -> None:
        self.left_scale = 1.0
        self.right_scale = 1.0
        self._step_m, self._track_m = geometry.step_m, geometry.wheel_base_m
        self._memory_ns = round(memory_s * 1e9)
        self._steps: WheelSteps | None = None
        self._states: deque[Reckoned] = deque()

    def advance(self, steps: WheelSteps, t_ns: int) -> tuple[float, float]:
        """Take in a reading of the step counters; return how far the left and right wheel rolled (m)."""
        if self._steps is None:
            self._steps = steps
            self._states.append(Reckoned(t_ns, 0.0, 0.0, 0.0, 0.0, 0.0))
            return 0.0, 0.0
        left_m = (steps.left - self._steps.left) * self._step_m * self.left_scale
        right_m = (steps.right - self._steps.right) * self._step_m * self.right_scale
        self._steps = steps
        self._states.append(self._moved(left_m, right_m, t_ns))
        while self._states[0].t_ns < t_ns - self._memory_ns:
            self._states.popleft()
        return left_m, right_m

    def _moved(self, left_m: float, right_m: float, t_ns: int) -> Reckoned:
        _, x_m, y_m, theta_rad, left_before_m, right_before_m = self._states[-1]
        half_turn_rad = 0.5 * (right_m - left_m) / self._track_m
        chord_m = 0.5 * (left_m + right_m)
        if half_turn_rad:
            chord_m *= math.sin(half_turn_rad) / half_turn_rad
        heading_rad = theta_rad + half_turn_rad
        return Reckoned(
            t_ns,
            x_m + chord_m * math.cos(heading_rad),
            y_m + chord_m * math.sin(heading_rad),
            heading_rad + half_turn_rad,
            left_before_m + left_m,
            right_before_m + right_m,
        )

    @property
    def newest(self) -> Reckoned:
        """The state at the last reading. Raises IndexError before the first."""
        return self._states[-1]

    def at(self, t_ns: int) -> Reckoned | None:
        """The state at a time, interpolated; the newest for a later time, None for one beyond the memory."""
        if self._states and self._states[-1].t_ns <= t_ns:
            return self._states[-1]
        after: Reckoned | None = None
        for state in reversed(self._states):
            if state.t_ns <= t_ns:
                return state if after is None or state.t_ns == t_ns else _between(state, after, t_ns)
            after = state
        return None


def _between(before: Reckoned, after: Reckoned, t_ns: int) -> Reckoned:
    part = (t_ns - before.t_ns) / (after.t_ns - before.t_ns)
    return Reckoned(
        t_ns,
        before.x_m + part * (after.x_m - before.x_m),
        before.y_m + part * (after.y_m - before.y_m),
        before.theta_rad + part * (after.theta_rad - before.theta_rad),
        before.left_m + part * (after.left_m - before.left_m),
        before.right_m + part * (after.right_m - before.right_m),
    )
