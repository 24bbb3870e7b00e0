"""Tells each robot its own pose, and the log what was not believed."""

from __future__ import annotations

from swarm.clock import NS_PER_S
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.node import Node
from tracker_bridge.backends.datagrams import Receiving
from tracker_bridge.backends.interface import Backend, Telling, TrackedPose
from tracker_bridge.capture_times import CaptureTimes
from tracker_bridge.plausibility import Plausibility

LOST_AFTER_NS = 2 * NS_PER_S
CARRIED_NS = 2 * NS_PER_S
"""How long a jump is no surprise after the simulated hand moved a robot: until five poses, a half second and
what was lost of them, agree that it is there."""


class Bridge:
    """Between a tracking system and the swarm. Poses of robots that the experiment does not name are left."""

    def __init__(
        self,
        backend: Backend,
        plausibility: Plausibility,
        node: Node,
        robots: list[str],
        lateness_s: float = 0.0,
        speed: float = 1.0,
    ) -> None:
        self._backend = backend
        self._telling = backend if isinstance(backend, Telling) else None
        self._receiving = backend if isinstance(backend, Receiving) else None
        self._plausibility = plausibility
        self._node = node
        self._seen_ns: dict[str, int | None] = dict.fromkeys(robots)
        self._refused: dict[str, str] = {}
        self._capture_times = CaptureTimes(self._report, lateness_s, speed)
        self._told_of: set[str] = set()
        self._carries = node.subscribe(topics.CARRY)
        self._carried_ns: dict[str, int] = {}

    def step(self, t_ns: int) -> None:
        """One tick: pass on what the tracking system measured since the last."""
        for carry in self._carries.take():
            self._carried_ns[carry.robot] = carry.header.t_ns
        for tracked in self._backend.poses(t_ns):
            if tracked.robot in self._seen_ns:
                self._pass_on(tracked, t_ns)
        for robot, seen_ns in self._seen_ns.items():
            if seen_ns is not None and t_ns - seen_ns > LOST_AFTER_NS:
                self._seen_ns[robot] = None
                self._report("lost", f"{robot}: no believable pose for {LOST_AFTER_NS // NS_PER_S} s")
        if self._telling:
            for name, text in self._telling.told():
                self._report(name, text)
        if self._receiving:
            self._tell_of_datagrams(self._receiving)

    def _pass_on(self, tracked: TrackedPose, t_ns: int) -> None:
        dated = self._capture_times.on_own_clock(tracked, t_ns)
        if dated is None:
            reason: str | None = "time: it was captured at no time that is possible"
        else:
            tracked, reason = dated, self._plausibility.reason_against(dated)
        kind = reason.split(" ")[0] if reason else ""
        is_news = reason and self._refused.get(tracked.robot) != kind
        if is_news and not (kind == "jump" and self._was_carried(tracked)):
            self._report("refused", f"{tracked.robot}: {reason}")
        self._refused[tracked.robot] = kind
        if reason:
            return
        self._seen_ns[tracked.robot] = tracked.captured_t_ns
        self._node.publish(topics.POSE, _message(tracked), tracked.robot)

    def _tell_of_datagrams(self, backend: Receiving) -> None:
        """Each reason for which datagrams are refused, once."""
        for reason in [reason for reason in backend.arrivals.refused if reason not in self._told_of]:
            self._told_of.add(reason)
            self._report("datagram", f"refused: {reason}")

    def _was_carried(self, tracked: TrackedPose) -> bool:
        """Whether a visit has just begun or ended: in a simulation a robot is elsewhere at once."""
        carried_ns = self._carried_ns.get(tracked.robot)
        return carried_ns is not None and abs(tracked.captured_t_ns - carried_ns) <= CARRIED_NS

    def _report(self, name: str, text: str) -> None:
        self._node.publish(topics.TRACKER_EVENT, pb.Event(level=pb.Event.WARNING, name=name, text=text))


def _message(tracked: TrackedPose) -> pb.Pose:
    return pb.Pose(
        x_m=tracked.pose.x_m,
        y_m=tracked.pose.y_m,
        theta_rad=tracked.pose.theta_rad,
        captured_t_ns=tracked.captured_t_ns,
        received_t_ns=tracked.received_t_ns,
        source_t_ns=tracked.source_t_ns,
        residual_m=tracked.residual_m,
        quality=tracked.quality,
    )
