"""All that a robot hears: its own pose, its own orders, the run's state, and an emergency stop."""

from __future__ import annotations

from collections.abc import Iterator

from swarm.clock import NS_PER_S
from swarm.config.experiment import RunSettings, WithoutServer
from swarm.geometry import Pose
from swarm.messages import swarm_pb2 as pb
from swarm.messages import topics
from swarm.runtime.emergency_latch import EmergencyLatch, by
from swarm.runtime.node import Node

HEARS_WITHIN_S = 0.25
"""Poses come ten times a second, one a control period: two may be missing, and at the third the wheels stand,
0.3 s after an emergency stop that gets lost. Half a second is allowed."""


class AgentInbox:
    """The four subscriptions of one robot.

    A robot goes on only while it hears the run's state; without it, it does what the run's settings say.
    An emergency stop stays in force in `latch`, whatever else is heard, until the server releases it.
    """

    def __init__(self, node: Node, robot: str, settings: RunSettings, latch: EmergencyLatch) -> None:
        self._node = node
        self._robot = robot
        self._poses = node.subscribe(topics.POSE, robot)
        self._orders = node.subscribe(topics.ORDER, robot)
        self._run_states = node.subscribe(topics.RUN_STATE)
        self._estops = node.subscribe(topics.ESTOP)
        self.latch = latch
        self.paused = False
        """Whether this robot is to stand although the others go on."""
        self._phase = pb.RunState.PHASE_UNSPECIFIED
        self._silent_ns = round(settings.without_server_s * NS_PER_S)
        self._stops_in_silence = settings.without_server is WithoutServer.STOP
        self._heard_ns = self._t_ns = 0
        self._losses = 0
        self.cut_off = False
        """Whether an emergency stop may have been sent that it has not heard: then the wheels stand."""
        self._order = pb.Order(kind=pb.Order.RUN)

    def poll(self, t_ns: int) -> None:
        """Take in the run's state and orders; what releases an emergency comes after all that declares it."""
        self._t_ns = t_ns
        states = self._run_states.take()
        self._judge_link(heard_state=bool(states))
        for stop in self._estops.take():
            self.latch.engage(f"emergency stop by {by(stop.message.operator, stop.message.reason)}")
        for state in states:
            self._phase = state.message.phase
            self._heard_ns = t_ns
            if self._phase == pb.RunState.ESTOPPED:
                self.latch.engage("emergency stop, says the server")
        for order in self._orders.take():
            self._obey(order.message)

    def _judge_link(self, *, heard_state: bool) -> None:
        """Whatever is heard comes in order; but what was sent while the connection was lost never comes. So
        after every gap the run's state, which tells of an emergency, has to be heard first.
        """
        losses, self._losses = self._losses, self._node.losses
        if self._node.lag_s() > HEARS_WITHIN_S or losses != self._losses:
            self.cut_off = True
        elif heard_state:
            self.cut_off = False

    def _obey(self, order: pb.Order) -> None:
        """What a robot is to do stays as it was while the robot is paused."""
        if order.kind == pb.Order.RELEASE:
            self.latch.release()
        elif order.kind in (pb.Order.PAUSE, pb.Order.RESUME):
            self.paused = order.kind == pb.Order.PAUSE
        else:
            self._order = order

    def fixes(self) -> Iterator[tuple[Pose, int]]:
        """The tracker's poses since the last call, each with the time it was captured, on this clock."""
        for received in self._poses.take():
            pose, offset_ns = received.message, self._node.offset_ns(topics.POSE, self._robot)
            yield Pose(pose.x_m, pose.y_m, pose.theta_rad), pose.captured_t_ns + offset_ns

    @property
    def running(self) -> bool:
        """Whether the robot may begin a move now."""
        goes_on = self._phase == pb.RunState.RUNNING and not self.paused
        return self._hears_server and goes_on and self._order.kind == pb.Order.RUN

    @property
    def _hears_server(self) -> bool:
        return self._t_ns - self._heard_ns <= self._silent_ns

    @property
    def held(self) -> str:
        """Why the robot is to stand although its trial goes on; empty if it is not."""
        if self._phase == pb.RunState.PAUSED:
            return "the run is paused"
        return "paused by itself" if self.paused else ""

    @property
    def visit_order(self) -> pb.Order | None:
        """The order to watch another robot, while it stands."""
        return self._order if self._order.kind == pb.Order.WATCH else None

    @property
    def stopped(self) -> bool:
        """Whether whatever is under way is given up: the trial is over, or its server is lost and the run's
        settings want that.
        """
        return self.server_lost or self._order.kind == pb.Order.STOP or self._phase == pb.RunState.ENDED

    @property
    def server_lost(self) -> bool:
        """Whether the server has been silent for so long that this robot stops at once."""
        return self._stops_in_silence and not self._hears_server

    @property
    def bad(self) -> int:
        """Messages refused so far."""
        return self._poses.bad + self._orders.bad + self._run_states.bad + self._estops.bad
