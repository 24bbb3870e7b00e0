"""Killed, stopped and continued agents: the wheels stand within 0.3 s by the emulated robot's own clock."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.kinematics import STOPPED
from robot_agent.emulator.emulation import Emulation, RobotToEmulate, default_address
from robot_agent.emulator.robot import EmulatedRobot
from tests.support.emulated_robot import HALL, LINKS, MIDDLE
from tests.support.swarm_runs import ROOT
from tests.support.waiting import until

FURTHEST_M = 0.04
LINK_IDS = ["-".join(link) for link in LINKS]


@contextmanager
def driven(
    link: str, model: str, place: Path, stops_at: int = -1
) -> Iterator[tuple[Emulation, subprocess.Popen[bytes]]]:
    """A robot under way, and the process of its agent."""
    wanted = RobotToEmulate(link, HALL, MIDDLE, model)
    address = default_address(link, place, "robot")
    with Emulation(wanted, address, time.monotonic_ns, np.random.default_rng(1)) as emulation:
        command = [
            sys.executable,
            "-m",
            "tests.support.driving_agent",
            link,
            emulation.address,
            str(stops_at),
        ]
        with subprocess.Popen(command, cwd=ROOT) as agent:
            try:
                until(lambda: has_driven(emulation.robot))
                yield emulation, agent
            finally:
                agent.kill()


def has_driven(robot: EmulatedRobot) -> bool:
    return any(speeds != STOPPED for _, speeds in list(robot.speeds))


def wait_until_it_stands_for_good(robot: EmulatedRobot, since_ns: int) -> int:
    """When the wheels stopped; not before whatever was under way at a moment has had its time."""
    over_ns = since_ns + round(STOP_WITHIN_S * 1e9)
    until(lambda: time.monotonic_ns() > over_ns and robot.standing_since_ns() is not None)
    stood_ns = robot.standing_since_ns()
    assert stood_ns is not None
    return stood_ns


def assert_stops_soon(emulation: Emulation, since_ns: int) -> None:
    """It stands within 0.3 s of a moment, and has not gone 4 cm."""
    with emulation.lock:
        began = emulation.robot.truth(time.monotonic_ns())
    stood_ns = wait_until_it_stands_for_good(emulation.robot, since_ns)
    assert stood_ns - since_ns <= STOP_WITHIN_S * 1e9
    with emulation.lock:
        ended = emulation.robot.truth(time.monotonic_ns())
    assert math.hypot(ended.x_m - began.x_m, ended.y_m - began.y_m) <= FURTHEST_M


def signal_and_measure(link: str, model: str, place: Path, number: signal.Signals, times: int) -> None:
    for _ in range(times):
        with driven(link, model, place) as (emulation, agent):
            os.kill(agent.pid, number)
            assert_stops_soon(emulation, since_ns=time.monotonic_ns())


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=lambda number: number.name)
@pytest.mark.parametrize(("link", "model"), LINKS, ids=LINK_IDS)
def test_the_wheels_of_a_killed_or_stopped_agent_stand(
    link: str, model: str, number: signal.Signals, tmp_path: Path
) -> None:
    signal_and_measure(link, model, tmp_path, number, 1)


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=lambda number: number.name)
@pytest.mark.parametrize(("link", "model"), LINKS, ids=LINK_IDS)
def test_they_stand_twenty_times_of_twenty(
    link: str, model: str, number: signal.Signals, tmp_path: Path
) -> None:
    signal_and_measure(link, model, tmp_path, number, 20)


@pytest.mark.parametrize(("link", "model"), LINKS, ids=LINK_IDS)
def test_what_an_agent_decided_before_it_was_stopped_is_not_obeyed_after(
    link: str, model: str, tmp_path: Path
) -> None:
    with driven(link, model, tmp_path, stops_at=3) as (emulation, agent):
        os.waitid(os.P_PID, agent.pid, os.WSTOPPED | os.WNOWAIT)
        wait_until_it_stands_for_good(emulation.robot, time.monotonic_ns())
        changes = len(emulation.robot.speeds)
        os.kill(agent.pid, signal.SIGCONT)
        assert agent.wait() == 0
        assert len(emulation.robot.speeds) == changes
