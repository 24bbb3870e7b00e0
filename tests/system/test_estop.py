"""An emergency stop: every wheel stands within half a second, and until somebody releases it."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from swarm.clock import unix_clock
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.parallel import available_cores
from swarm.runtime.operating import publish_estop
from tests.support.emulated_laboratory import EmulatedLaboratory
from tests.support.endpoints import free_endpoint
from tests.support.namespaces import Star, can_make_namespaces, inside
from tests.support.operator import Operator, Order, all_are

STANDS_WITHIN_S = 0.5
ROBOTS, EMERGENCIES = 2, 50
LOSS = 0.2
PRECEDENCE = 10
WITHOUT_PRECEDENCE = ["nice", "-n", str(PRECEDENCE)]
PORT = 7447


def until(condition: Callable[[], bool]) -> None:
    """Look again and again."""
    for _ in unix_clock().ticks(0.05):
        if condition():
            return


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def released(operator: Operator) -> bool:
    """Release, and again those that a bad link has kept from hearing of it."""
    latched = any(robot.estopped for robot in operator.sees().robots)
    if latched:
        with suppress(UserError):
            operator.orders(Order.RELEASE)
    return not latched


def resumed(operator: Operator) -> bool:
    """Resume, whether or not the answer comes in time."""
    if operator.sees().phase == pb.RunState.RUNNING:
        return True
    with suppress(UserError):
        operator.orders(Order.RESUME)
    return False


def times_to_stand_s(laboratory: EmulatedLaboratory, operator: Operator) -> list[float]:
    """One emergency while all robots drive, and its release."""
    until(lambda: all(map(laboratory.drives, laboratory.names)))
    began_ns = laboratory.now_ns()
    publish_estop(operator.session, Order(operator="anna@lab"))
    operator.waits_until(all_are("estopped"))
    until(lambda: all(laboratory.stood_after_s(name, began_ns) < math.inf for name in laboratory.names))
    took_s = [laboratory.stood_after_s(name, began_ns) for name in laboratory.names]
    until(lambda: released(operator))
    until(lambda: resumed(operator))
    return took_s


@pytest.mark.faults
@pytest.mark.skipif(not can_make_namespaces(), reason="needs network namespaces and TUN devices")
def test_all_wheels_stand_in_time_fifty_times_of_fifty_although_a_fifth_of_the_packets_is_lost(
    tmp_path: Path, stack: ExitStack
) -> None:
    """The server's machine is busy on every core. Boards, robots and links have machines of their own, and in
    their place precedence here.
    """
    os.nice(-PRECEDENCE)
    stack.callback(os.nice, PRECEDENCE)
    star = Star("estop", ROBOTS, stack)
    laboratory = EmulatedLaboratory(tmp_path, stack, f"tcp/{star.hub_address(0)}:{PORT}", ROBOTS)
    hub = [*inside(star.hub), *WITHOUT_PRECEDENCE]
    laboratory.serve(f"tcp/0.0.0.0:{PORT}", inside=hub)
    laboratory.track(f"tcp/127.0.0.1:{PORT}", inside=hub)
    laboratory.emulate()
    for link, (name, board) in enumerate(zip(laboratory.names, star.boards, strict=True), 1):
        laboratory.agent(name, f"tcp/{star.hub_address(link)}:{PORT}", inside=inside(board))
    operator = laboratory.operator()
    until(lambda: all(map(laboratory.drives, laboratory.names)))
    for link in range(1, ROBOTS + 1):
        star.lose(link, LOSS)
    for _ in available_cores():
        busy = stack.enter_context(
            subprocess.Popen([*WITHOUT_PRECEDENCE, sys.executable, "-c", "while True: pass"])
        )
        stack.callback(busy.kill)
    took_s = [time_s for _ in range(EMERGENCIES) for time_s in times_to_stand_s(laboratory, operator)]
    print(f"worst {max(took_s):.3f} s, median {sorted(took_s)[len(took_s) // 2]:.3f} s of {len(took_s)}")
    assert max(took_s) <= STANDS_WITHIN_S


@pytest.mark.faults
def test_it_is_latched_over_a_restart_of_any_process(tmp_path: Path, stack: ExitStack) -> None:
    laboratory = EmulatedLaboratory(tmp_path, stack, free_endpoint(), 1)
    server = laboratory.serve()
    tracker = laboratory.track()
    laboratory.emulate()
    agent = laboratory.agent("r0")
    operator = laboratory.operator()
    until(lambda: laboratory.drives("r0"))
    began_ns = laboratory.now_ns()
    assert operator.orders(Order.ESTOP).accepted
    operator.waits_until(all_are("estopped"))
    restarts: list[tuple[subprocess.Popen[bytes], Callable[[], object]]] = [
        (agent, lambda: laboratory.agent("r0")),
        (tracker, laboratory.track),
        (server, lambda: laboratory.serve(resume=True)),
    ]
    for process, again in restarts:
        process.kill()
        process.wait()
        again()
        status = operator.waits_until(lambda status: not status.missing and status.robots[0].heard_age_s < 1)
        assert status.phase == pb.RunState.ESTOPPED
        operator.waits_until(all_are("estopped"))
        assert operator.orders(Order.RESUME).text.endswith("release it first")
        assert laboratory.stood_after_s("r0", began_ns) < math.inf
    assert operator.orders(Order.RELEASE).accepted
    assert operator.waits_until(all_are("waiting")).phase == pb.RunState.PAUSED
    assert laboratory.stood_after_s("r0", began_ns) <= STANDS_WITHIN_S, "it has not moved since"
    assert operator.orders(Order.RESUME).accepted
    until(lambda: laboratory.drives("r0"))
