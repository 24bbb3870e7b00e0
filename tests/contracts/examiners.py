"""What every driver must do, written once.

To have a new body examined, write a rig for it (the body, and the world behind it) and add one line to the
list in `test_body_contract.py`; for a tracker backend, in `test_backend_contract.py`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import pytest

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds, WheelSteps
from swarm.geometry import Pose, wrap_angle_rad
from tracker_bridge.backends.interface import Backend, TrackedPose

SECOND_NS = 1_000_000_000
TICK_NS = SECOND_NS // 10
MOTORS_REL = 0.048
"""The e-puck1's timer of 0.1 ms has no speed nearer than this to some wanted ones (between 909 and 1000)."""


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


def _steps_at(rig: BodyRig, t_ns: int) -> WheelSteps:
    rig.run_to(t_ns)
    return rig.body.wheel_steps(t_ns)


def _driven(rig: BodyRig, speeds: WheelSpeeds, t_ns: int, ticks: int) -> tuple[WheelSpeeds, int]:
    """Look and command as an agent does, so many ticks long; the speeds really sent and when it ended."""
    sent = STOPPED
    for _ in range(ticks):
        _steps_at(rig, t_ns)
        sent = rig.body.drive(speeds, t_ns)
        t_ns += TICK_NS
    return sent, t_ns


def _steps_in_two_seconds(rig: BodyRig, speeds: WheelSpeeds, t_ns: int) -> tuple[WheelSpeeds, int, int, int]:
    """Give speeds half a second to take effect, and count the steps of the next two seconds."""
    _, t_ns = _driven(rig, speeds, t_ns, 5)
    before = _steps_at(rig, t_ns)
    sent, t_ns = _driven(rig, speeds, t_ns, 20)
    after = _steps_at(rig, t_ns)
    return sent, after.left - before.left, after.right - before.right, t_ns


def _has_the_three_methods(rig: BodyRig, t_ns: int) -> int:
    assert isinstance(rig.body, Body)
    return t_ns


def _stands_before_the_first_command(rig: BodyRig, t_ns: int) -> int:
    before = _steps_at(rig, t_ns)
    t_ns += SECOND_NS
    assert _steps_at(rig, t_ns) == before
    return t_ns


def _each_wheel_turns_as_sent(rig: BodyRig, t_ns: int) -> int:
    """What is sent may differ from what was wanted by what the motors' timers allow."""
    for speeds in (WheelSpeeds(300.0, 120.0), WheelSpeeds(-250.0, 90.0), WheelSpeeds(0.0, -400.0)):
        sent, left, right, t_ns = _steps_in_two_seconds(rig, speeds, t_ns)
        assert sent.left_steps_per_s == pytest.approx(speeds.left_steps_per_s, rel=MOTORS_REL)
        assert sent.right_steps_per_s == pytest.approx(speeds.right_steps_per_s, rel=MOTORS_REL)
        assert left == pytest.approx(2.0 * sent.left_steps_per_s, abs=2)
        assert right == pytest.approx(2.0 * sent.right_steps_per_s, abs=2)
    return t_ns


def _clips_and_says_what_it_sent(rig: BodyRig, t_ns: int) -> int:
    fastest = rig.geometry.max_steps_per_s
    sent, left, right, t_ns = _steps_in_two_seconds(rig, WheelSpeeds(4.0 * fastest, -2.0 * fastest), t_ns)
    assert sent.left_steps_per_s == pytest.approx(fastest, rel=0.01)
    assert sent.right_steps_per_s == pytest.approx(-0.5 * fastest, rel=0.01), "slowed by one factor"
    assert left == pytest.approx(2.0 * sent.left_steps_per_s, abs=2)
    assert right == pytest.approx(2.0 * sent.right_steps_per_s, abs=2)
    return t_ns


def _refuses_speeds_that_are_not_finite(rig: BodyRig, t_ns: int) -> int:
    _, t_ns = _driven(rig, STOPPED, t_ns, 10)
    standing = _steps_at(rig, t_ns)
    for bad in (math.nan, math.inf, -math.inf):
        with pytest.raises(ValueError, match="finite"):
            rig.body.drive(WheelSpeeds(100.0, bad), t_ns)
    t_ns += SECOND_NS
    assert _steps_at(rig, t_ns) == standing, "a refused command must not reach the wheels"
    return t_ns


def _counts_past_sixteen_bits(rig: BodyRig, t_ns: int) -> int:
    """Eighty seconds forward and back: each counter passes its wrap both ways."""
    fastest = rig.geometry.max_steps_per_s
    start = _steps_at(rig, t_ns)
    for direction, seconds in ((1.0, 80.0), (-1.0, 0.0)):
        sent, t_ns = _driven(rig, WheelSpeeds(direction * fastest, -direction * fastest), t_ns, 800)
        steps, full = _steps_at(rig, t_ns), abs(sent.left_steps_per_s)
        assert steps.left - start.left == pytest.approx(seconds * full, abs=0.2 * fastest)
        assert steps.right - start.right == pytest.approx(-seconds * full, abs=0.2 * fastest)
    return t_ns


def _stops_when_commands_cease(rig: BodyRig, t_ns: int) -> int:
    """Nobody calls it any more, for whatever reason: the wheels stand 0.3 s after the last command."""
    fastest = rig.geometry.max_steps_per_s
    _, t_ns = _driven(rig, WheelSpeeds(fastest, fastest), t_ns, 5)
    last = _steps_at(rig, t_ns - TICK_NS).left
    rig.run_to(t_ns - TICK_NS + round(STOP_WITHIN_S * SECOND_NS))
    assert rig.motors_stand(t_ns - TICK_NS + round(STOP_WITHIN_S * SECOND_NS))
    assert 0 < _steps_at(rig, t_ns + SECOND_NS).left - last <= (STOP_WITHIN_S + 0.06) * fastest
    return t_ns + SECOND_NS


def _closing_stops_the_motors(rig: BodyRig, t_ns: int) -> int:
    _, t_ns = _driven(rig, WheelSpeeds(500.0, 500.0), t_ns, 10)
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
    _stops_when_commands_cease,
    _closing_stops_the_motors,
)
"""The checks of a body; each takes a fresh rig and the time at which to begin, and returns when it ended."""


class BackendRig(Protocol):
    """A tracking system with the world behind it, simulated or emulated: robot "a" stands at (1.0, 0.5) m
    in an arena of 3 x 2 m and heads north, robot "b" at (2.0, 1.5) m and heads west.
    """

    tolerance_m: float
    tolerance_rad: float

    @property
    def backend(self) -> Backend:
        """The backend to be examined."""

    def run_to(self, t_ns: int) -> None:
        """Let the world's time pass up to `t_ns`."""

    def close(self) -> None:
        """Close what was opened."""


def _seen_in(rig: BackendRig, seconds: int, t_ns: int) -> list[tuple[int, list[TrackedPose]]]:
    """What the backend gives at the ticks of some seconds, ten a second, with each tick's time."""
    seen = []
    for _ in range(10 * seconds):
        t_ns += SECOND_NS // 10
        rig.run_to(t_ns)
        seen.append((t_ns, rig.backend.poses(t_ns)))
    return seen


def _sees_each_robot_where_it_is(rig: BackendRig, t_ns: int) -> None:
    places = {"a": Pose(1.0, 0.5, math.pi / 2), "b": Pose(2.0, 1.5, math.pi)}
    poses = [tracked for _, given in _seen_in(rig, 5, t_ns) for tracked in given]
    assert {tracked.robot for tracked in poses} == set(places)
    for tracked in poses:
        place = places[tracked.robot]
        assert tracked.pose.distance_m(place) <= rig.tolerance_m
        turned_rad = wrap_angle_rad(tracked.pose.theta_rad - place.theta_rad)
        assert abs(turned_rad) <= rig.tolerance_rad


def _times_are_of_capture_and_rise(rig: BackendRig, t_ns: int) -> None:
    began_ns, last_ns = t_ns, {"a": -1, "b": -1}
    for now_ns, given in _seen_in(rig, 5, t_ns):
        for tracked in given:
            assert began_ns <= tracked.captured_t_ns <= now_ns
            assert tracked.captured_t_ns > last_ns[tracked.robot]
            last_ns[tracked.robot] = tracked.captured_t_ns
    assert min(last_ns.values()) > began_ns + 3 * SECOND_NS, "it goes on seeing"


def _gives_nothing_twice(rig: BackendRig, t_ns: int) -> None:
    t_ns = _seen_in(rig, 2, t_ns)[-1][0]
    assert rig.backend.poses(t_ns) == []


BACKEND_CHECKS: tuple[Callable[[BackendRig, int], None], ...] = (
    _sees_each_robot_where_it_is,
    _times_are_of_capture_and_rise,
    _gives_nothing_twice,
)
"""The checks of a tracker backend; each takes a fresh rig and the time at which to begin."""
