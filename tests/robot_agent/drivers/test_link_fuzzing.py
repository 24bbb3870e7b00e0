"""Random and mutated replies over every link: no crash, no hang, no false pose, no command by mistake."""

from __future__ import annotations

import socket
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

import numpy as np
import pytest

from robot_agent.drivers.byte_line import ByteLine
from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.i2c import I2cBus, probed
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, StepUnwrapper, WheelSpeeds, WheelSteps
from robot_agent.drivers.motors import EPUCK1, EPUCK2, YORK
from robot_agent.drivers.robot_link import RobotLink
from robot_agent.drivers.serial import SerialLink
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.drivers.spi import SpiLink
from robot_agent.drivers.step_gate import FASTEST_STEPS_PER_S, SLACK_STEPS
from robot_agent.drivers.watchdog import MISTAKE, Watchdog
from robot_agent.drivers.wifi import WifiLink
from robot_agent.emulator.asercom import Asercom
from robot_agent.emulator.buses import EmulatedSmbus, EmulatedSpiDev
from robot_agent.emulator.emulation import FASTEST_STEPS_PER_S as UNCLIPPED
from robot_agent.emulator.esp32 import Esp32
from robot_agent.emulator.faults import Faults
from robot_agent.emulator.i2c_slaves import GumstixSlave, YorkSlave
from robot_agent.emulator.lpuck import LpuckSlave
from robot_agent.emulator.robot import EmulatedRobot
from tests.support.emulated_robot import HALL, LINKS, MIDDLE, Clock, LocalChannel

TICK_NS = 100_000_000
SPEEDS = (WheelSpeeds(700.0, -300.0), WheelSpeeds(-400.0, 650.0), WheelSpeeds(250.0, 250.0))
LINK_IDS = ["-".join(link) for link in LINKS]
WRONG_STEPS = 16
MOST_WRONG = {"serial": 5, "wifi": 250, "i2c": 20, "spi": 5}
"""Of 100,000. An even number of bits that turn over in the same place of I2C's bytes passes their checksum.
Wi-Fi's have TCP's alone: when they are spoilt behind it, a bit among the lowest seven of a counter cannot be
told from a wheel that turned. What passes is no further off than the wheels can have turned."""
MOST_LOST = {"serial": 0, "wifi": 2 * SLACK_STEPS + FASTEST_STEPS_PER_S * TICK_NS * 1e-9, "i2c": 0, "spi": 0}
"""How far the counts may be off at the end, in steps: over Wi-Fi the last reading may be a wrong one."""
MOST_WRONG_OF_1000 = {"serial": 0, "wifi": 5, "i2c": 1, "spi": 0}
SILENCE_S = 0.005
"""What counts as silence here, where the robot is a thread away."""


@dataclass
class Mutator:
    """Makes replies worse; `on` only while a body is under test, not while its link is opened."""

    rng: np.random.Generator
    on: bool = False
    last: bytes = b""
    made: Counter[str] = field(default_factory=Counter)

    def __call__(self, reply: bytes) -> bytes:
        if not self.on or not reply:
            return reply
        kinds = (self._good, self._random, self._flipped, self._shifted, self._repeated, self._cut)
        kind = kinds[int(self.rng.choice(len(kinds), p=(0.4, 0.2, 0.2, 0.12, 0.06, 0.02)))]
        self.made[kind.__name__] += 1
        worse, self.last = kind(reply), reply
        return worse

    def _good(self, reply: bytes) -> bytes:
        return reply

    def _random(self, reply: bytes) -> bytes:
        return self.rng.bytes(len(reply))

    def _flipped(self, reply: bytes) -> bytes:
        spoilt = bytearray(reply)
        for bit in self.rng.integers(8 * len(reply), size=int(self.rng.integers(1, 9))).tolist():
            spoilt[bit // 8] ^= 1 << bit % 8
        return bytes(spoilt)

    def _shifted(self, reply: bytes) -> bytes:
        at = int(self.rng.integers(len(reply)))
        return reply[:at] + self.rng.bytes(int(self.rng.integers(1, 9))) + reply[at:]

    def _repeated(self, reply: bytes) -> bytes:
        return self.last or reply

    def _cut(self, reply: bytes) -> bytes:
        return reply[: int(self.rng.integers(len(reply)))]


class FuzzedRobot:
    """A robot whose replies are made worse, and all that it was ever told."""

    def __init__(self, link: str, model: str, seed: int) -> None:
        rng = np.random.default_rng(seed)
        geometry = EpuckGeometry(max_steps_per_s=UNCLIPPED)
        body = SimulatedBody(geometry, BodyFaults(0.0, 0.0, 0.0), MIDDLE, HALL, rng)
        motors = {"i2cepuck1": YORK}.get(link + model, EPUCK1 if model == "epuck1" else EPUCK2)
        self.robot = EmulatedRobot(body, motors, HALL, Faults(), 15 if link == "wifi" else 10)
        self.clock = Clock(TICK_NS)
        self.mutate = Mutator(rng)
        self.told: set[WheelSpeeds] = set()
        self._link, self._model, self._rng = link, model, rng
        self._ends: list[socket.socket] = []
        self._threads: list[threading.Thread] = []

    def open(self) -> RobotLink:
        """A link as after a good start."""
        was_on, self.mutate.on = self.mutate.on, False
        try:
            return self._opened()
        finally:
            self.mutate.on = was_on

    def _opened(self) -> RobotLink:
        if self._link == "serial":
            asercom = Asercom(self.robot, self._model, self._rng)
            return SerialLink(self._line(lambda data: asercom.receive(data, self.clock.t_ns)), SILENCE_S, 0.0)
        if self._link == "wifi":
            return WifiLink(self._line(self._wifi()), SILENCE_S)
        if self._link == "spi":
            lpuck = LpuckSlave(self.robot, self._rng)
            return SpiLink(EmulatedSpiDev(lambda sent: self._heard(lpuck.transfer(sent, self.clock.t_ns))))
        kind = GumstixSlave if self._model == "epuck2" else YorkSlave
        slave = kind(self.robot, self._rng)

        def transfer(address: int, written: bytes, count: int) -> bytes:
            reply = slave.transfer(address, written, count, self.clock.t_ns)
            return self._heard(reply).ljust(count, b"\x00")[:count]

        return probed(I2cBus(EmulatedSmbus(transfer)), lambda: 0.0)

    def _wifi(self) -> Callable[[bytes], bytes]:
        firmware = Esp32(self.robot, self._rng, 0)
        firmware.connected()

        def answer(data: bytes) -> bytes:
            firmware.receive(data, self.clock.t_ns)
            return firmware.stream(self.clock.t_ns)

        return answer

    def _heard(self, reply: bytes) -> bytes:
        """What the robot has been told is noted whenever it answers."""
        self.told |= {speeds for _, speeds in self.robot.speeds}
        self.robot.speeds.clear()
        return self.mutate(reply)

    def _line(self, answer: Callable[[bytes], bytes]) -> ByteLine:
        ours, theirs = socket.socketpair()

        def serve() -> None:
            with suppress(OSError), theirs:
                while data := theirs.recv(4096):
                    theirs.sendall(self._heard(answer(data)))

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        self._ends.append(ours)
        self._threads.append(thread)
        return ByteLine(ours)

    def close(self) -> None:
        for end in self._ends:
            end.close()
        for thread in self._threads:
            thread.join()


@contextmanager
def fuzzed(link: str, model: str, seed: int) -> Iterator[tuple[FuzzedRobot, EpuckBody]]:
    """A body whose robot's replies are made worse from now on."""
    robot = FuzzedRobot(link, model, seed)
    heard: deque[bytes] = deque()
    watchdog = Watchdog(robot.open, robot.clock.now_ns, heard.append)
    events: list[tuple[str, str]] = []
    body = EpuckBody(
        LocalChannel(watchdog, heard),
        EpuckGeometry(),
        robot.clock.now_ns,
        1.0,
        lambda *event: events.append(event),
    )
    body.wait_for_robot()
    robot.mutate.on = True
    yield robot, body
    assert not [text for _, text in events if MISTAKE in text]
    robot.mutate.on = False
    watchdog.close()
    robot.close()


@dataclass
class Findings:
    """What a series of bad replies did to the counts of one wheel or the other."""

    replies: Counter[str]
    wrong: int = 0
    """Readings let through that were more than 2 mm off."""
    worst_steps: int = 0
    """The furthest that one was off."""
    lost_steps: int = 0
    """How far the counts are off at the end: what was driven while nothing good was heard."""


def fuzz(link: str, model: str, replies: int, seed: int) -> Findings:
    """Drive under bad replies, and hold each tick's counts against what the wheels really did."""
    with fuzzed(link, model, seed) as (robot, body):
        findings = Findings(robot.mutate.made)
        truth = TrueSteps(robot)
        meant = {STOPPED}
        heard_ns = robot.clock.t_ns
        while findings.replies.total() < replies:
            robot.clock.t_ns += TICK_NS
            steps = body.wheel_steps(0)
            truth.advance()
            assert_possible(truth.error(steps), robot.clock.t_ns - heard_ns)
            if body.health.reading_age_s == 0.0:
                findings.worst_steps = max(findings.worst_steps, truth.newly_off(steps))
                findings.wrong += truth.newly_off(steps) > WRONG_STEPS
                truth.off = truth.error(steps)
                heard_ns = robot.clock.t_ns
            meant.add(body.drive(SPEEDS[robot.clock.t_ns // (50 * TICK_NS) % len(SPEEDS)], 0))
        findings.lost_steps = max(map(abs, truth.off))
    assert_only_meant(robot.told, meant, one_wheel_at_a_time=(link, model) == ("i2c", "epuck1"))
    return findings


class TrueSteps:
    """What the wheels really did, and how far a body's counts are off it."""

    def __init__(self, robot: FuzzedRobot) -> None:
        self._robot = robot
        self._unwrapper = StepUnwrapper()
        self._now = self._before = WheelSteps(0, 0)
        self.advance()
        self._start = self._now
        self.off = (0, 0)
        """How far the counts were off at the last reading that was let through."""

    def advance(self) -> None:
        self._before = self._now
        self._now = self._unwrapper.unwrap(*self._robot.robot.counters(self._robot.clock.t_ns))

    def error(self, steps: WheelSteps, then: WheelSteps | None = None) -> tuple[int, int]:
        then = then or self._now
        return steps.left - then.left + self._start.left, steps.right - then.right + self._start.right

    def newly_off(self, steps: WheelSteps) -> int:
        """By how much a reading is wrong: one that repeats what was true a tick ago is only late."""
        errors = [self.error(steps), self.error(steps, self._before)]
        errors += [(left - self.off[0], right - self.off[1]) for left, right in errors]
        return min(max(abs(left), abs(right)) for left, right in errors)


def assert_possible(error: tuple[int, int], silent_ns: int) -> None:
    """The counts are off by no more than wheels can have turned since the robot was last understood, one way
    in truth and the other way in a wrong reading; two readings go into one look, each with its slack."""
    assert max(map(abs, error)) <= 2 * (SLACK_STEPS + FASTEST_STEPS_PER_S * silent_ns * 1e-9)


def assert_only_meant(told: set[WheelSpeeds], meant: set[WheelSpeeds], *, one_wheel_at_a_time: bool) -> None:
    """The robot has been told nothing that the agent did not say; York's takes one wheel after the other."""
    if one_wheel_at_a_time:
        lefts = {speeds.left_steps_per_s for speeds in meant}
        rights = {speeds.right_steps_per_s for speeds in meant}
        meant = {WheelSpeeds(left, right) for left in lefts for right in rights}
    assert told <= meant


@pytest.mark.parametrize(("link", "model"), LINKS, ids=LINK_IDS)
def test_bad_replies_do_no_harm(link: str, model: str) -> None:
    findings = fuzz(link, model, 1000, seed=1)
    assert len(findings.replies) == 6
    assert findings.wrong <= MOST_WRONG_OF_1000[link]


@pytest.mark.long
@pytest.mark.parametrize(("link", "model"), LINKS, ids=LINK_IDS)
def test_a_hundred_thousand_bad_replies_do_no_harm(link: str, model: str) -> None:
    findings = fuzz(link, model, 100_000, seed=2)
    print(link, model, findings)
    assert findings.wrong <= MOST_WRONG[link]
    assert findings.lost_steps <= MOST_LOST[link]
