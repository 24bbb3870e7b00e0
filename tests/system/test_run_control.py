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
from tests.support.swarm_runs import messages


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


@pytest.mark.long
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


@pytest.mark.faults
def test_a_battery_is_changed_in_a_pause_and_nothing_learnt_is_lost(tmp_path: Path, stack: ExitStack) -> None:
    """The other robot goes on meanwhile; the one with the new battery waits until it is resumed."""
    laboratory = Laboratory(tmp_path, stack, count=2)
    laboratory.serve()
    operator = Operator(stack.enter_context(Session(SessionSettings(laboratory.endpoint))))
    operator.sees()
    laboratory.track()
    laboratory.agent("r0")
    flat = laboratory.agent("r1")
    operator.waits_until(lambda status: min(robot.moves for robot in status.robots) > 3)
    assert operator.orders(Order.PAUSE, "r1", reason="battery").accepted
    operator.waits_until(lambda status: any(event.name == "paused" for event in status.events))
    flat.kill()
    gone = operator.waits_until(lambda status: not status.robots[1].present)
    laboratory.agent("r1")
    back = operator.waits_until(
        lambda status: status.robots[1].present and status.robots[0].moves > gone.robots[0].moves + 8
    )
    assert back.robots[1].moves == gone.robots[1].moves
    assert back.robots[1].paused
    assert operator.orders(Order.RESUME, "r1").accepted
    operator.waits_until(lambda status: status.robots[1].moves > gone.robots[1].moves + 3)
    numbers = [move.number for robot, move in heard_moves(tmp_path / "run", operator) if robot == "r1"]
    assert numbers == list(range(1, len(numbers) + 1)), "every move once, across the change"


def heard_moves(run: Path, operator: Operator) -> list[tuple[str, pb.Move]]:
    """All moves of a run, once it is stopped."""
    assert operator.orders(Order.STOP).accepted
    while (run / "endpoint").exists():
        pass
    return list(messages(run / "trial-000.mcap", "move"))
