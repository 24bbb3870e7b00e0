"""Where the robot itself was a moment ago: a camera's frame comes later than its exposure."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque

from swarm.geometry import Pose, wrap_angle_rad

POSES_REMEMBERED = 64
"""Six seconds at ten ticks a second; a simulated frame is at most thirty ticks late."""


class OwnPoses:
    """The robot's own poses at the last ticks."""

    def __init__(self) -> None:
        self._poses: deque[tuple[int, Pose]] = deque(maxlen=POSES_REMEMBERED)

    def add(self, pose: Pose, t_ns: int) -> None:
        """Call in the order of time."""
        self._poses.append((t_ns, pose))

    def at(self, t_ns: int) -> Pose:
        """The pose at a time, interpolated; the oldest or the newest known beyond. IndexError without any."""
        after = bisect_left(self._poses, t_ns, key=lambda known: known[0])
        if after == len(self._poses):
            return self._poses[-1][1]
        after_ns, later = self._poses[after]
        if after == 0 or after_ns == t_ns:
            return later
        before_ns, before = self._poses[after - 1]
        return _between(before, later, (t_ns - before_ns) / (after_ns - before_ns))


def _between(before: Pose, later: Pose, part: float) -> Pose:
    turned_rad = wrap_angle_rad(later.theta_rad - before.theta_rad)
    return Pose(
        before.x_m + part * (later.x_m - before.x_m),
        before.y_m + part * (later.y_m - before.y_m),
        wrap_angle_rad(before.theta_rad + part * turned_rad),
    )
