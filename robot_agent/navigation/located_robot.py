"""A robot's wheels together with where they have brought it: under a tracker, or by its wheels alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from robot_agent.drivers.interfaces import Body
from robot_agent.navigation.pose_estimator import PoseEstimator
from swarm.geometry import Pose

Fixes = Callable[[], Sequence[tuple[Pose, int]]]
"""The tracker's poses since the last call, each with the time at which it was measured."""
OWN_FRAME = Pose(0.0, 0.0, 0.0)
"""Without a tracker a robot's frame begins where it stands."""


class LocatedRobot:
    """Observe it once a tick, then drive its body. `fixes` is None without a tracker."""

    def __init__(self, body: Body, estimator: PoseEstimator, fixes: Fixes | None) -> None:
        self.body = body
        self._estimator = estimator
        self._fixes = fixes

    def observe(self, t_ns: int) -> Pose | None:
        """Where the robot believes to be now; None before the tracker's first pose."""
        self._estimator.odometry(self.body.wheel_steps(t_ns), t_ns)
        if self._fixes is None:
            if self._estimator.pose(t_ns) is None:
                self._estimator.fix(OWN_FRAME, t_ns)
        else:
            for pose, captured_t_ns in self._fixes():
                self._estimator.fix(pose, captured_t_ns)
        return self._estimator.pose(t_ns)

    def pose_at(self, t_ns: int) -> Pose | None:
        """What it believes now of where it was then."""
        return self._estimator.pose(t_ns)

    def pose_age_s(self, t_ns: int) -> float:
        """The age of the fix under the pose; the wheels' own reckoning is always new."""
        return 0.0 if self._fixes is None else self._estimator.age_s(t_ns)
