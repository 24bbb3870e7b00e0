"""Each fault of a link in real time: right counts, an entry for the log, and a robot that goes on."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.epuck_driver import KINDS, now_at, opened_body
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds
from robot_agent.drivers.robot_link import wrapped_difference
from robot_agent.drivers.watchdog_process import WatchdogProcess
from robot_agent.emulator.emulation import Emulation, RobotToEmulate, default_address
from robot_agent.emulator.faults import Faults
from swarm.clock import unix_clock
from tests.support.emulated_robot import HALL, LINKS, MIDDLE, EmulatedRig

SPEEDS = (WheelSpeeds(600.0, 500.0), WheelSpeeds(-300.0, 400.0), STOPPED, STOPPED)
TICKS_A_SPEED = 8


@dataclass
class Findings:
    """What a drive over a faulty link came to."""

    events: list[tuple[str, str]]
    off_steps: int
    """How far the counts were off at the end."""
    longest_silence_s: float
    failed: int
    refused: int


def drive(link: str, model: str, faults: Faults, seconds: float, place: Path) -> Findings:
    """Forward, a turn, a rest, and again; then stand until the robot has answered once more."""
    wanted = RobotToEmulate(link, HALL, MIDDLE, model, faults=faults)
    events: list[tuple[str, str]] = []
    address = default_address(link, place, "robot")
    with Emulation(wanted, address, time.monotonic_ns, np.random.default_rng(4)) as emulation:
        body = opened_body(
            KINDS[link], emulation.address, EpuckGeometry(), 1.0, lambda *event: events.append(event)
        )
        try:
            body.wait_for_robot()
            start = body.wheel_steps(0)
            with emulation.lock:
                counters = emulation.robot.counters(time.monotonic_ns())
            silence_s = _driven(body, round(10 * seconds))
            end = body.wheel_steps(0)
            with emulation.lock:
                after = emulation.robot.counters(time.monotonic_ns())
        finally:
            body.close()
    off = [
        wrapped_difference(now - before, count - first)
        for now, before, count, first in (
            (after[0], counters[0], end.left, start.left),
            (after[1], counters[1], end.right, start.right),
        )
    ]
    health = body.health
    return Findings(events, max(map(abs, off)), silence_s, health.failed_exchanges, health.refused_readings)


def _driven(body: EpuckBody, ticks: int) -> float:
    """The longest time without a reading."""
    silence_s = 0.0
    for tick, t_ns in enumerate(unix_clock().ticks(0.1)):
        body.wheel_steps(t_ns)
        silence_s = max(silence_s, body.health.reading_age_s)
        ended = tick >= ticks
        body.drive(STOPPED if ended else SPEEDS[tick // TICKS_A_SPEED % len(SPEEDS)], t_ns)
        if ended and tick >= ticks + 5 and body.health.reading_age_s < 0.2:
            return silence_s
    raise AssertionError("the clock never ends")


def test_a_watchdog_that_is_killed_is_replaced(tmp_path: Path) -> None:
    """The new one stops the robot first; the counts go on."""
    wanted = RobotToEmulate("serial", HALL, MIDDLE)
    events: list[tuple[str, str]] = []
    address = default_address("serial", tmp_path, "robot")
    with Emulation(wanted, address, time.monotonic_ns, np.random.default_rng(4)) as emulation:
        channel = WatchdogProcess(KINDS["serial"].opener, emulation.address, 1.0)
        body = EpuckBody(channel, EpuckGeometry(), now_at(1.0), 1.0, lambda *event: events.append(event))
        body.wait_for_robot()
        before = body.wheel_steps(0)
        os.kill(channel.pid, signal.SIGKILL)
        silence_s = _driven(body, 20)
        after = body.wheel_steps(0)
        with emulation.lock:
            counters = emulation.robot.counters(time.monotonic_ns())
        body.close()
    print("watchdog killed", silence_s)
    assert ("watchdog", "the watchdog has ended; a new one stops the robot and goes on") in events
    assert after != before
    assert wrapped_difference(after.left, counters[0]) == wrapped_difference(after.right, counters[1]) == 0


@pytest.mark.parametrize("left_over", [b"\n", b"\xbc\x01", b"V", b"\xf7"], ids=repr)
def test_a_serial_robot_that_is_lost_in_its_bytes_is_led_back(left_over: bytes, tmp_path: Path) -> None:
    """A line feed too much, a batch or a text that was cut: the firmware would wait for ever."""
    rig = EmulatedRig("serial", "epuck2", tmp_path)
    with open(rig.emulation.address, "wb", buffering=0) as line:
        line.write(left_over)
    t_ns, silent = rig.clock.t_ns, 0
    for _ in range(10):
        t_ns += 100_000_000
        rig.run_to(t_ns)
        rig.body.wheel_steps(t_ns)
        silent += rig.body.health.reading_age_s > 0.05
        rig.body.drive(SPEEDS[0], t_ns)
    rig.run_to(t_ns + 1)
    rig.close()
    assert silent <= 4
    assert rig.emulation.robot.commanded != (0, 0), "it obeys again"


@pytest.mark.parametrize(("link", "model"), LINKS, ids=["-".join(link) for link in LINKS])
def test_a_robot_that_was_reset_goes_on_from_the_counts_it_had(link: str, model: str, tmp_path: Path) -> None:
    rig = EmulatedRig(link, model, tmp_path)
    t_ns = rig.clock.t_ns
    for tick in range(100):
        t_ns += 100_000_000
        rig.run_to(t_ns)
        steps = rig.body.wheel_steps(t_ns)
        rig.body.drive(SPEEDS[0], t_ns)
        if tick == 50:
            at_reset = steps
            rig.emulation.robot.reset(t_ns)
    rig.close()
    assert rig.body.health.refused_readings == 1
    driven = 5.0 * SPEEDS[0].left_steps_per_s
    assert 0.9 * driven < steps.left - at_reset.left < 1.01 * driven


def says(findings: Findings, name: str, text: str) -> bool:
    return any(event == name and text in said for event, said in findings.events)


Check = Callable[[Findings], bool]
FAULTS: dict[str, tuple[tuple[tuple[str, str], ...], Faults, Check]] = {
    "bad checksums": ((("i2c", "epuck2"),), Faults(bad_checksum=0.05), lambda found: found.failed <= 2),
    "failed transfers": (LINKS[3:], Faults(failure=0.01), lambda found: found.failed <= 4),
    "answers in pieces": (LINKS[:3], Faults(pieces=0.1), lambda found: found.longest_silence_s < 1.0),
    "a greeting in mid-stream": (LINKS[:2], Faults(banner=0.1), lambda found: found.failed > 0),
    "pauses": ((("wifi", "epuck2"),), Faults(stall=0.02), lambda found: found.longest_silence_s > 1.0),
    "a low battery": (
        (LINKS[1], LINKS[2]),
        Faults(sag_v_per_s=0.5),
        lambda found: says(found, "battery", "charge the robot"),
    ),
    "a TV remote": (
        LINKS[:1],
        Faults(remote_after_s=0.5),
        lambda found: says(found, "moved", "TV remote"),
    ),
}
CASES = [
    pytest.param(link, model, faults, check, id=f"{name} over {link}-{model}")
    for name, (links, faults, check) in FAULTS.items()
    for link, model in links
]


@pytest.mark.parametrize(("link", "model"), LINKS, ids=["-".join(link) for link in LINKS])
def test_a_link_that_drops_is_opened_anew(link: str, model: str, tmp_path: Path) -> None:
    """What the wheels did meanwhile is in the counts, since they are the robot's own."""
    found = drive(link, model, Faults(drop_after_s=2.0, drop_for_s=0.5), 2.5, tmp_path)
    print(link, model, found)
    assert says(found, "link", "link lost")
    assert says(found, "link", "link is back after")
    assert found.off_steps == 0


@pytest.mark.long
@pytest.mark.parametrize(("link", "model", "faults", "check"), CASES)
def test_a_faulty_link_gives_right_counts(
    link: str, model: str, faults: Faults, check: Check, tmp_path: Path
) -> None:
    found = drive(link, model, faults, 6.0, tmp_path)
    print(link, model, found)
    assert check(found)
    if not faults.remote_after_s:
        assert found.off_steps == 0
