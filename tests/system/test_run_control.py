"""A live run in a person's hands: it tells how it goes, and obeys."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.messages import swarm_pb2 as pb
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.laboratory import Laboratory
from tests.support.operator import Operator, Order, all_are, moves


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def test_a_run_from_waiting_to_stopped(tmp_path: Path, stack: ExitStack) -> None:
    laboratory = Laboratory(tmp_path, stack, count=2)
    server = laboratory.serve()
    operator = Operator(stack.enter_context(Session(SessionSettings(laboratory.endpoint))))
    waiting = operator.sees()
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
    server.communicate()
    assert server.returncode == 0
