"""What the plausibility gate lets pass, and why it refuses the rest."""

from __future__ import annotations

import math

import pytest

from swarm.clock import NS_PER_S
from swarm.geometry import Pose
from tracker_bridge.backends.interface import TrackedPose
from tracker_bridge.plausibility import Plausibility, PlausibilitySettings

SETTINGS = PlausibilitySettings(3.0, 2.0)
PERIOD_NS = NS_PER_S // 10


def seen(number: int, x_m: float, y_m: float = 1.0, theta_rad: float = 0.0, robot: str = "a") -> TrackedPose:
    return TrackedPose(robot, Pose(x_m, y_m, theta_rad), number * PERIOD_NS)


@pytest.fixture
def plausibility() -> Plausibility:
    plausibility = Plausibility(SETTINGS)
    assert plausibility.reason_against(seen(0, 1.0)) is None
    return plausibility


def test_a_robot_that_drives_is_believed(plausibility: Plausibility) -> None:
    for number in range(1, 50):
        assert plausibility.reason_against(seen(number, 1.0 + 0.013 * number)) is None


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
def test_what_is_refused(plausibility: Plausibility, pose: TrackedPose, said: str) -> None:
    assert said in (plausibility.reason_against(pose) or "")


def test_a_little_beyond_the_edge_is_believed() -> None:
    assert Plausibility(SETTINGS).reason_against(seen(0, 3.2, y_m=-0.2)) is None


def test_a_single_jump_is_forgotten(plausibility: Plausibility) -> None:
    assert plausibility.reason_against(seen(1, 2.0))
    assert plausibility.reason_against(seen(2, 1.01)) is None


def test_a_robot_that_stays_where_it_jumped_is_believed_the_fifth_time(plausibility: Plausibility) -> None:
    verdicts = [plausibility.reason_against(seen(number, 2.0 + 0.001 * number)) for number in range(1, 7)]
    assert [verdict is None for verdict in verdicts] == [False] * 4 + [True] * 2


def test_jumps_to_and_fro_are_not_believed(plausibility: Plausibility) -> None:
    """Not while it could not have driven there: the reach grows with the time since it was last believed."""
    for number in range(1, 13):
        assert plausibility.reason_against(seen(number, 2.0 if number % 2 else 0.3))


def test_a_tracker_that_repeats_itself_is_frozen(plausibility: Plausibility) -> None:
    verdicts = [plausibility.reason_against(seen(number, 1.0)) for number in range(1, 40)]
    assert verdicts[: SETTINGS.frozen_after - 1] == [None] * (SETTINGS.frozen_after - 1)
    assert all("frozen" in (verdict or "") for verdict in verdicts[SETTINGS.frozen_after - 1 :])
    assert plausibility.reason_against(seen(40, 1.0001)) is None


def test_robots_are_judged_one_by_one(plausibility: Plausibility) -> None:
    assert plausibility.reason_against(seen(1, 2.5, robot="b")) is None
    assert plausibility.reason_against(seen(1, 1.01)) is None


FAST_NS = NS_PER_S // 300


def fast(number: int, x_m: float, robot: str = "a") -> TrackedPose:
    """A pose of a tracker of 300 Hz."""
    return TrackedPose(robot, Pose(x_m, 1.0, 0.0), NS_PER_S + number * FAST_NS)


def test_a_speed_no_robot_has_is_refused_however_small_its_steps(plausibility: Plausibility) -> None:
    """At 2 m/s and 300 Hz a step is 7 mm, less than the slack."""
    verdicts = [plausibility.reason_against(fast(number, 1.0 + 2.0 * number / 300)) for number in range(150)]
    assert verdicts[0] is None
    assert all("jump" in (verdict or "") for verdict in verdicts[100:])


def test_a_jump_is_not_believed_sooner_because_poses_come_faster(plausibility: Plausibility) -> None:
    assert plausibility.reason_against(fast(0, 1.0)) is None
    verdicts = [plausibility.reason_against(fast(number, 2.5 + 1e-5 * number)) for number in range(1, 200)]
    refused = sum(verdict is not None for verdict in verdicts)
    assert refused == pytest.approx(300 * SETTINGS.believe_after_ns / NS_PER_S, abs=2)


def test_a_robot_on_anothers_place_is_taken_for_it(plausibility: Plausibility) -> None:
    assert plausibility.reason_against(fast(0, 1.0)) is None
    assert plausibility.reason_against(fast(0, 2.0, robot="b")) is None
    verdicts = [plausibility.reason_against(fast(number, 2.0 + 1e-4 * number)) for number in range(1, 600)]
    assert all((verdict or "").startswith("swapped with b?") for verdict in verdicts)
    assert plausibility.reason_against(fast(600, 1.01)) is None


def test_a_place_that_another_left_long_ago_may_be_jumped_to(plausibility: Plausibility) -> None:
    assert plausibility.reason_against(seen(0, 2.0, robot="b")) is None
    for number in range(1, 20):
        assert plausibility.reason_against(seen(number, 1.0 + 1e-4 * number)) is None
    verdicts = [plausibility.reason_against(seen(number, 2.0 + 1e-4 * number)) for number in range(20, 26)]
    assert [verdict is None for verdict in verdicts] == [False] * 4 + [True] * 2
