"""What every driver must do, written once.

To have a new body examined, write a rig for it (the body, and the world behind it) and add one line to the
list in `tests/test_body_contract.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import pytest

from robot_agent.drivers.body import Body, WheelSpeeds, WheelSteps
from robot_agent.drivers.epuck import EpuckGeometry

SECOND_NS = 1_000_000_000


class BodyRig(Protocol):
    """A body with the world behind it: a simulation, or emulated hardware at the other end of a link.

    At the start the wheels stand and no command has been sent.
    """

    geometry: EpuckGeometry

    @property
    def body(self) -> Body:
        """The body to be examined."""

    def run_to(self, t_ns: int) -> None:
        """Let the world's time pass up to `t_ns`."""

    def motors_stand(self, t_ns: int) -> bool:
        """Whether the motors themselves stand at `t_ns` and after; works on a closed body as well."""


def _steps_in_two_seconds(rig: BodyRig, speeds: WheelSpeeds, t_ns: int) -> tuple[WheelSpeeds, int, int, int]:
    """Send speeds, give them half a second to take effect, and count the steps of the next two seconds."""
    sent = rig.body.drive(speeds, t_ns)
    before = _steps_at(rig, t_ns + SECOND_NS // 2)
    t_ns += SECOND_NS // 2 + 2 * SECOND_NS
    after = _steps_at(rig, t_ns)
    return sent, after.left - before.left, after.right - before.right, t_ns


def _steps_at(rig: BodyRig, t_ns: int) -> WheelSteps:
    rig.run_to(t_ns)
    return rig.body.wheel_steps(t_ns)


def _has_the_three_methods(rig: BodyRig, t_ns: int) -> int:
    assert isinstance(rig.body, Body)
    return t_ns


def _stands_before_the_first_command(rig: BodyRig, t_ns: int) -> int:
    before = _steps_at(rig, t_ns)
    t_ns += SECOND_NS
    assert _steps_at(rig, t_ns) == before
    return t_ns


def _each_wheel_turns_as_sent(rig: BodyRig, t_ns: int) -> int:
    for speeds in (WheelSpeeds(300.0, 120.0), WheelSpeeds(-250.0, 90.0), WheelSpeeds(0.0, -400.0)):
        sent, left, right, t_ns = _steps_in_two_seconds(rig, speeds, t_ns)
        assert sent == speeds
        assert left == pytest.approx(2.0 * speeds.left_steps_per_s, abs=2)
        assert right == pytest.approx(2.0 * speeds.right_steps_per_s, abs=2)
    return t_ns


def _clips_and_says_what_it_sent(rig: BodyRig, t_ns: int) -> int:
    fastest = rig.geometry.max_steps_per_s
    sent, left, right, t_ns = _steps_in_two_seconds(rig, WheelSpeeds(4.0 * fastest, -2.0 * fastest), t_ns)
    assert sent == WheelSpeeds(fastest, -0.5 * fastest), "both wheels are slowed by one factor"
    assert left == pytest.approx(2.0 * sent.left_steps_per_s, abs=2)
    assert right == pytest.approx(2.0 * sent.right_steps_per_s, abs=2)
    return t_ns


def _refuses_speeds_that_are_not_finite(rig: BodyRig, t_ns: int) -> int:
    rig.body.drive(WheelSpeeds(0.0, 0.0), t_ns)
    standing = _steps_at(rig, t_ns + SECOND_NS)
    for bad in (math.nan, math.inf, -math.inf):
        with pytest.raises(ValueError, match="finite"):
            rig.body.drive(WheelSpeeds(100.0, bad), t_ns + SECOND_NS)
    t_ns += 2 * SECOND_NS
    assert _steps_at(rig, t_ns) == standing, "a refused command must not reach the wheels"
    return t_ns


def _counts_past_sixteen_bits(rig: BodyRig, t_ns: int) -> int:
    """Eighty seconds forward and back: each counter passes its wrap both ways."""
    fastest = rig.geometry.max_steps_per_s
    start = _steps_at(rig, t_ns)
    for direction, distance in ((1.0, 80.0), (-1.0, 0.0)):
        rig.body.drive(WheelSpeeds(direction * fastest, -direction * fastest), t_ns)
        for _ in range(16):
            t_ns += 5 * SECOND_NS
            steps = _steps_at(rig, t_ns)
        assert steps.left - start.left == pytest.approx(distance * fastest, abs=0.5 * fastest)
        assert steps.right - start.right == pytest.approx(-distance * fastest, abs=0.5 * fastest)
    return t_ns


def _closing_stops_the_motors(rig: BodyRig, t_ns: int) -> int:
    rig.body.drive(WheelSpeeds(500.0, 500.0), t_ns)
    t_ns += SECOND_NS
    rig.run_to(t_ns)
    assert not rig.motors_stand(t_ns)
    rig.body.close()
    rig.body.close()
    t_ns += 2 * SECOND_NS
    rig.run_to(t_ns)
    assert rig.motors_stand(t_ns)
    return t_ns


BODY_CHECKS: tuple[Callable[[BodyRig, int], int], ...] = (
    _has_the_three_methods,
    _stands_before_the_first_command,
    _each_wheel_turns_as_sent,
    _clips_and_says_what_it_sent,
    _refuses_speeds_that_are_not_finite,
    _counts_past_sixteen_bits,
    _closing_stops_the_motors,
)
"""The checks of a body; each takes a fresh rig and the time at which to begin, and returns when it ended."""
