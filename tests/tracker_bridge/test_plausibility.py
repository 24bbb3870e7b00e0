"""What the plausibility gate lets pass, and why it refuses the rest."""

from __future__ import annotations

import math

import pytest

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.plausibility import Gate, GateSettings

SETTINGS = GateSettings(3.0, 2.0)
PERIOD_NS = NS_PER_S // 10


def seen(number: int, x_m: float, y_m: float = 1.0, theta_rad: float = 0.0, robot: str = "a") -> TrackedPose:
    return TrackedPose(robot, Pose(x_m, y_m, theta_rad), number * PERIOD_NS)


@pytest.fixture
def gate() -> Gate:
    gate = Gate(SETTINGS)
    assert gate.reason_against(seen(0, 1.0)) is None
    return gate


def test_a_robot_that_drives_is_believed(gate: Gate) -> None:
    for number in range(1, 50):
        assert gate.reason_against(seen(number, 1.0 + 0.013 * number)) is None


@pytest.mark.parametrize(
    ("pose", "said"),
    [
        (seen(1, math.nan), "not a number"),
        (seen(1, 1.0, theta_rad=math.inf), "not a number"),
        (seen(1, 3.3), "outside the arena"),
        (seen(1, 1.0, y_m=-0.3), "outside the arena"),
        (seen(1, 1000.0, y_m=900.0), "is it in millimetres?"),
        (seen(1, 1.0, theta_rad=90.0), "is it in degrees?"),
        (seen(0, 1.0), "older than the one before"),
        (seen(1, 1.5), "jump of 0.50 m"),
    ],
)
def test_what_is_refused(gate: Gate, pose: TrackedPose, said: str) -> None:
    assert said in (gate.reason_against(pose) or "")


def test_a_little_beyond_the_edge_is_believed() -> None:
    assert Gate(SETTINGS).reason_against(seen(0, 3.2, y_m=-0.2)) is None


def test_a_single_jump_is_forgotten(gate: Gate) -> None:
    assert gate.reason_against(seen(1, 2.0))
    assert gate.reason_against(seen(2, 1.01)) is None


def test_a_robot_that_stays_where_it_jumped_is_believed_the_fifth_time(gate: Gate) -> None:
    verdicts = [gate.reason_against(seen(number, 2.0 + 0.001 * number)) for number in range(1, 7)]
    assert [verdict is None for verdict in verdicts] == [False] * 4 + [True] * 2


def test_jumps_to_and_fro_are_not_believed(gate: Gate) -> None:
    """Not while it could not have driven there: the reach grows with the time since it was last believed."""
    for number in range(1, 13):
        assert gate.reason_against(seen(number, 2.0 if number % 2 else 0.3))


def test_a_tracker_that_repeats_itself_is_frozen(gate: Gate) -> None:
    verdicts = [gate.reason_against(seen(number, 1.0)) for number in range(1, 40)]
    assert verdicts[: SETTINGS.frozen_after - 1] == [None] * (SETTINGS.frozen_after - 1)
    assert all("frozen" in (verdict or "") for verdict in verdicts[SETTINGS.frozen_after - 1 :])
    assert gate.reason_against(seen(40, 1.0001)) is None


def test_robots_are_judged_one_by_one(gate: Gate) -> None:
    assert gate.reason_against(seen(1, 2.5, robot="b")) is None
    assert gate.reason_against(seen(1, 1.01)) is None
