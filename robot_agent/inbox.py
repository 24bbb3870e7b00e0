"""All that a robot hears: its own pose, its own orders, the run's state."""

from __future__ import annotations

from collections.abc import Iterator

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.node import Node

CONDUCTOR_SILENT_S = 5.0
"""Chosen: five of the run states that come once a second, so that a lost message or two stop nobody."""


class AgentInbox:
    """The three subscriptions of one robot.

    A robot goes on only while it hears the run's state: after 5 s without it finishes its move and waits.
    """

    def __init__(self, node: Node, robot: str) -> None:
        self._poses = node.subscribe(topics.POSE, robot)
        self._orders = node.subscribe(topics.ORDER, robot)
        self._run_states = node.subscribe(topics.RUN_STATE)
        self._phase = pb.RunState.PHASE_UNSPECIFIED
        self._heard_ns = 0
        self._order = pb.Order(kind=pb.Order.RUN)

    def poll(self, t_ns: int) -> None:
        """Take in orders and the run's state."""
        for order in self._orders.take():
            self._order = order.message
        for state in self._run_states.take():
            self._phase = state.message.phase
            self._heard_ns = t_ns

    def fixes(self) -> Iterator[tuple[Pose, int]]:
        """The tracker's poses since the last call, each with the time it was captured."""
        for received in self._poses.take():
            pose = received.message
            yield Pose(pose.x_m, pose.y_m, pose.theta_rad), pose.captured_t_ns

    def running(self, t_ns: int) -> bool:
        """Whether the robot may begin a move now."""
        heard = t_ns - self._heard_ns <= CONDUCTOR_SILENT_S * NS_PER_S
        return heard and self._phase == pb.RunState.RUNNING and self._order.kind == pb.Order.RUN

    @property
    def visit_order(self) -> pb.Order | None:
        """The order to watch another robot, while it stands."""
        return self._order if self._order.kind == pb.Order.WATCH else None

    @property
    def stopped(self) -> bool:
        """Whether the trial is over for this robot."""
        return self._order.kind == pb.Order.STOP or self._phase == pb.RunState.ENDED

    @property
    def bad(self) -> int:
        """Messages refused so far."""
        return self._poses.bad + self._orders.bad + self._run_states.bad
