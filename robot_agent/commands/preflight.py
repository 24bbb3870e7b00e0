"""What is tried with a real robot before a run, and what to do about what is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import islice

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.epuck_body import EpuckBody
from robot_agent.drivers.kinematics import STOPPED, WheelSpeeds, WheelSteps
from robot_agent.drivers.notices import LOW_BATTERY_V

SLOW_STEPS_PER_S = 200.0
"""2.6 cm/s: slow enough to catch the robot."""
WHEEL_TICKS = 10
"""A second for each wheel and way."""
SETTLE_TICKS = 5
WHEEL_REL = 0.2
"""A command takes effect up to two ticks late: what is further off is a wheel that misses steps."""
OTHER_WHEEL_STEPS = 10
"""What the wheel that stands may seem to have turned."""
STOP_STEPS = round(SLOW_STEPS_PER_S * (STOP_WITHIN_S + 0.1))
"""How far the wheels may turn after the last command: 0.3 s, and a tick until it is looked."""
QUALITY_TICKS = 30
MOST_FAILED = 0.02
"""Share of exchanges without an answer from which a link is called bad."""
TOUCHING_RAW = 1000
"""Something stands nearer than 1.5 cm."""


class Verdict(Enum):
    """What a check came to."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"


@dataclass(frozen=True)
class Finding:
    """One line of the table; the cure is for what is not good."""

    check: str
    verdict: Verdict
    found: str
    cure: str = ""


def preflight(body: EpuckBody, ticks: Iterator[int], *, moves: bool) -> Iterator[Finding]:
    """The checks of a robot whose link is open, in an order in which each may rely on those before."""
    yield _quality(body, ticks)
    yield _battery(body)
    yield _proximity(body)
    if moves:
        for name, speeds in WHEELS:
            yield _wheel(body, ticks, name, speeds)
        yield _stop(body, ticks)


WHEELS = (
    ("left wheel", WheelSpeeds(SLOW_STEPS_PER_S, 0.0)),
    ("left wheel back", WheelSpeeds(-SLOW_STEPS_PER_S, 0.0)),
    ("right wheel", WheelSpeeds(0.0, SLOW_STEPS_PER_S)),
    ("right wheel back", WheelSpeeds(0.0, -SLOW_STEPS_PER_S)),
)


def _quality(body: EpuckBody, ticks: Iterator[int]) -> Finding:
    before = body.health.failed_exchanges
    _drive(body, ticks, STOPPED, QUALITY_TICKS)
    failed = body.health.failed_exchanges - before
    found = f"{failed} of {2 * QUALITY_TICKS} exchanges without an answer"
    cure = "bring the robot nearer, charge it, look at the cable; others may use the radio channel"
    return _judged("link", failed <= MOST_FAILED * 2 * QUALITY_TICKS, found, cure)


def _battery(body: EpuckBody) -> Finding:
    volts = body.health.battery_v
    if not volts:
        return Finding("battery", Verdict.DOUBTFUL, "the robot does not say", "look at its power light")
    return _judged("battery", volts >= LOW_BATTERY_V, f"{volts:.2f} V", "charge the robot")


def _proximity(body: EpuckBody) -> Finding:
    echoes = body.health.proximity
    if not any(echoes):
        return Finding("proximity", Verdict.DOUBTFUL, "no echoes at all", "is its firmware the right one?")
    nearest = max(range(len(echoes)), key=echoes.__getitem__)
    found = f"largest echo {echoes[nearest]} at ps{nearest}"
    return _judged("proximity", echoes[nearest] < TOUCHING_RAW, found, "give the robot room")


def _wheel(body: EpuckBody, ticks: Iterator[int], name: str, speeds: WheelSpeeds) -> Finding:
    """One wheel turns as commanded while the other stands."""
    before = body.wheel_steps(next(ticks))
    running = _drive(body, ticks, speeds, WHEEL_TICKS)
    _drive(body, ticks, STOPPED, SETTLE_TICKS)
    after = body.wheel_steps(next(ticks))
    turned = after.left - before.left, after.right - before.right
    wanted = running.left_steps_per_s, running.right_steps_per_s
    right = all(_is_near(steps, speed) for steps, speed in zip(turned, wanted, strict=True))
    found = f"{turned[0]} and {turned[1]} steps, {wanted[0]:.0f} and {wanted[1]:.0f} commanded"
    return _judged(name, right, found, "is the wheel free? do the motors' cables sit where they belong?")


def _is_near(steps: int, steps_per_s: float) -> bool:
    """A second at a speed, from standing to standing."""
    return abs(steps - steps_per_s) <= OTHER_WHEEL_STEPS + WHEEL_REL * abs(steps_per_s)


def _stop(body: EpuckBody, ticks: Iterator[int]) -> Finding:
    """Both wheels turn back and forth, and then nobody commands any more."""
    speeds = WheelSpeeds(-SLOW_STEPS_PER_S, SLOW_STEPS_PER_S)
    _drive(body, ticks, speeds, SETTLE_TICKS)
    last = body.wheel_steps(next(ticks))
    for t_ns in islice(ticks, WHEEL_TICKS):
        stood = body.wheel_steps(t_ns)
    after = body.wheel_steps(next(ticks))
    turned = _turned(last, after)
    found = f"{turned} steps after the last command"
    stands = turned <= STOP_STEPS and _turned(stood, after) == 0
    return _judged("stop without commands", stands, found, "do not use the robot: report this")


def _turned(before: WheelSteps, after: WheelSteps) -> int:
    return max(abs(after.left - before.left), abs(after.right - before.right))


def _drive(body: EpuckBody, ticks: Iterator[int], speeds: WheelSpeeds, count: int) -> WheelSpeeds:
    """Look and command so many ticks long; the speeds that the motors really run at."""
    running = STOPPED
    for t_ns in islice(ticks, count):
        body.wheel_steps(t_ns)
        running = body.drive(speeds, t_ns)
    return running


def _judged(check: str, good: bool, found: str, cure: str) -> Finding:
    return Finding(check, Verdict.GOOD, found) if good else Finding(check, Verdict.BAD, found, cure)
