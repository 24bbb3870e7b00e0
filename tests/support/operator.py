"""A person at the controls of a live run."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from swarm.clock import unix_clock
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.operating import ask_status, send_order
from swarm.runtime.zenoh_session import Session

Order = pb.OperatorOrder


class Operator:
    """Gives orders under one name, and looks at the run until it is as it should be."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def orders(
        self, kind: Order.Kind.ValueType, *robots: str, reason: str = "", prompt: int = 0
    ) -> pb.OrderAnswer:
        order = Order(kind=kind, operator="anna@lab", reason=reason, robots=robots, prompt=prompt)
        self.sees()
        return send_order(self.session, order)

    def sees(self) -> pb.RunStatus:
        """Asks again if nobody answers: the server has not begun yet, or waits for a bad link."""
        while True:
            with suppress(UserError):
                return ask_status(self.session)

    def waits_until(self, condition: Callable[[pb.RunStatus], bool]) -> pb.RunStatus:
        """Ask until the run is as wanted."""
        for _ in unix_clock().ticks(0.1):
            status = self.sees()
            if condition(status):
                return status
        raise AssertionError("a clock has no last tick")


def moves(status: pb.RunStatus) -> int:
    """Of all robots together."""
    return sum(robot.moves for robot in status.robots)


def all_are(*activities: str) -> Callable[[pb.RunStatus], bool]:
    """Whether all robots say that they are about one of these."""
    return lambda status: all(robot.activity in activities for robot in status.robots)
