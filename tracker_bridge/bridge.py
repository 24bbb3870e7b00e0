"""Tells each robot its own pose, and the log what was not believed."""

from __future__ import annotations

from swarm.clock import NS_PER_S
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.node import Link
from tracker_bridge.backends.interface import Backend, TrackedPose
from tracker_bridge.plausibility import Gate

LOST_AFTER_NS = 2 * NS_PER_S


class Bridge:
    """Between a tracking system and the swarm. Poses of robots that the experiment does not name are left."""

    def __init__(self, backend: Backend, gate: Gate, link: Link, robots: list[str]) -> None:
        self._backend = backend
        self._gate = gate
        self._link = link
        self._seen_ns: dict[str, int | None] = dict.fromkeys(robots)
        self._refused: dict[str, str] = {}

    def step(self, t_ns: int) -> None:
        """One tick: pass on what the tracking system measured since the last."""
        for tracked in self._backend.poses(t_ns):
            if tracked.robot in self._seen_ns:
                self._pass_on(tracked)
        for robot, seen_ns in self._seen_ns.items():
            if seen_ns is not None and t_ns - seen_ns > LOST_AFTER_NS:
                self._seen_ns[robot] = None
                self._report("lost", f"{robot}: no believable pose for {LOST_AFTER_NS // NS_PER_S} s")

    def _pass_on(self, tracked: TrackedPose) -> None:
        reason = self._gate.reason_against(tracked)
        kind = reason.split(" ")[0] if reason else ""
        if reason and self._refused.get(tracked.robot) != kind:
            self._report("refused", f"{tracked.robot}: {reason}")
        self._refused[tracked.robot] = kind
        if reason:
            return
        self._seen_ns[tracked.robot] = tracked.captured_t_ns
        pose = tracked.pose
        message = pb.Pose(
            x_m=pose.x_m, y_m=pose.y_m, theta_rad=pose.theta_rad, captured_t_ns=tracked.captured_t_ns
        )
        self._link.publish(topics.POSE, message, tracked.robot)

    def _report(self, name: str, text: str) -> None:
        self._link.publish(topics.TRACKER_EVENT, pb.Event(level=pb.Event.WARNING, name=name, text=text))
