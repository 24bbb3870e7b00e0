"""A live run in a person's hands: it tells how it goes, and obeys."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.clock import unix_clock
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.operating import ask_status, send_order
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.laboratory import Laboratory

Order = pb.OperatorOrder


class Operator:
    """A person with a session."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def orders(self, kind: Order.Kind.ValueType, *robots: str, reason: str = "") -> pb.OrderAnswer:
        order = Order(kind=kind, operator="anna@lab", reason=reason, robots=robots)
        return send_order(self.session, order)

    def waits_until(self, condition: Callable[[pb.RunStatus], bool]) -> pb.RunStatus:
        """Ask until the run is as wanted."""
        for _ in unix_clock().ticks(0.1):
            status = ask_status(self.session)
            if condition(status):
                return status
        raise AssertionError


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[Laboratory]:
    """Two learners, a tracker bridge and a server."""
    with ExitStack() as stack:
        found = Laboratory(tmp_path, stack, count=2)
        found.server = found.serve()
        yield found


@pytest.fixture
def operator(laboratory: Laboratory) -> Iterator[Operator]:
    with Session(SessionSettings(laboratory.endpoint)) as session:
        yield Operator(session)


def moves(status: pb.RunStatus) -> int:
    return sum(robot.moves for robot in status.robots)


def all_are(activity: str) -> Callable[[pb.RunStatus], bool]:
    return lambda status: all(robot.activity == activity for robot in status.robots)


def test_a_run_from_waiting_to_stopped(laboratory: Laboratory, operator: Operator) -> None:
    waiting = operator.waits_until(lambda status: True)
    assert waiting.phase == pb.RunState.PREPARING
    assert list(waiting.missing) == ["r0", "r1", "the tracker bridge"]
    laboratory.track()
    laboratory.agent("r0")
    laboratory.agent("r1")
    going = operator.waits_until(lambda status: moves(status) > 4)
    assert going.phase == pb.RunState.RUNNING
    assert not going.missing
    assert operator.orders(Order.PAUSE, reason="lunch").accepted
    paused = operator.waits_until(lambda status: status.phase == pb.RunState.PAUSED)
    assert paused.reason == "anna@lab (lunch)"
    assert operator.orders(Order.PAUSE).text == "the run is paused already"
    print(paused)
    assert operator.orders(Order.RESUME).accepted
    operator.waits_until(lambda status: moves(status) > moves(paused) + 2)
    assert operator.orders(Order.ESTOP, reason="a hand").accepted
    stopped = operator.waits_until(all_are("estopped"))
    assert stopped.phase == pb.RunState.ESTOPPED
    refused = operator.orders(Order.RESUME)
    assert not refused.accepted
    assert refused.text == "emergency stop by anna@lab (a hand): release it first"
    assert operator.orders(Order.RELEASE).accepted
    assert operator.waits_until(all_are("waiting")).phase == pb.RunState.PAUSED
    assert operator.orders(Order.RESUME).accepted
    operator.waits_until(lambda status: moves(status) > moves(stopped) + 2)
    assert operator.orders(Order.STOP, reason="enough").accepted
    laboratory.server.communicate()
    assert laboratory.server.returncode == 0
