"""The simulated e-puck moves like one, and the same however often it is watched."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from swarm.geometry import Compartment, Grid, Pose

SECOND_NS = 1_000_000_000
WALLS = Compartment(1.0, 2.0, Grid(10, 10), 0.12)
MIDDLE = Pose(1.6, 2.6, 0.0)
PERFECT = BodyFaults(slip_sd=0.0, gain_error_sd=0.0, latency_s=0.0)


def body(faults: BodyFaults = PERFECT, pose: Pose = MIDDLE, seed: int = 0) -> SimulatedBody:
    return SimulatedBody(EpuckGeometry(), faults, pose, WALLS, np.random.default_rng(seed))


def test_drives_straight_by_its_steps() -> None:
    robot = body()
    robot.drive(WheelSpeeds(500.0, 500.0), SECOND_NS)
    end = robot.truth(3 * SECOND_NS)
    assert (end.x_m, end.y_m, end.theta_rad) == pytest.approx((1.6 + 1000 * 0.1288e-3, 2.6, 0.0))
    assert robot.wheel_steps(3 * SECOND_NS).left == 1000


def test_drives_an_exact_arc() -> None:
    geometry, robot = EpuckGeometry(), body()
    sent = robot.drive(geometry.wheel_speeds(0.05, 0.5), SECOND_NS)
    left_m, right_m = sent.left_steps_per_s * geometry.step_m, sent.right_steps_per_s * geometry.step_m
    turn = (right_m - left_m) / geometry.wheel_base_m
    radius_m = 0.5 * (left_m + right_m) / turn
    end = robot.truth(SECOND_NS + 2_340_000_000)
    expected = (1.6 + radius_m * math.sin(2.34 * turn), 2.6 + radius_m * (1 - math.cos(2.34 * turn)))
    assert (end.x_m, end.y_m) == pytest.approx(expected, abs=1e-12)
    assert end.theta_rad == pytest.approx(2.34 * turn)


def test_a_quarter_turn_in_place_takes_323_steps() -> None:
    robot = body()
    robot.drive(WheelSpeeds(-323.0, 323.0), 0)
    end = robot.truth(SECOND_NS)
    assert end.theta_rad == pytest.approx(math.pi / 2, abs=0.002)
    assert end.distance_m(MIDDLE) < 1e-12


def test_a_command_takes_effect_after_the_latency() -> None:
    robot = body(BodyFaults(0.0, 0.0, latency_s=0.06))
    robot.drive(WheelSpeeds(1000.0, 1000.0), SECOND_NS)
    robot.drive(WheelSpeeds(0.0, 0.0), SECOND_NS + 10_000_000)
    assert robot.wheel_steps(SECOND_NS + 59_000_000).left == 0
    assert robot.wheel_steps(SECOND_NS + 65_000_000).left == 5
    assert robot.wheel_steps(2 * SECOND_NS).left == 10


def test_watching_changes_nothing_to_the_last_bit() -> None:
    faults = BodyFaults(slip_sd=0.05, gain_error_sd=0.02, latency_s=0.037)
    by_the_wall = Pose(WALLS.west_m + 0.05, 2.6, math.pi)
    watched, alone = body(faults, by_the_wall, seed=3), body(faults, by_the_wall, seed=3)
    rng = np.random.default_rng(9)
    for tick in range(300):
        t_ns = SECOND_NS + tick * 83_000_000
        speeds = WheelSpeeds(*rng.uniform(-600, 900, 2).tolist()) if tick % 7 else WheelSpeeds(0.0, 0.0)
        for body_under_test in (watched, alone):
            body_under_test.drive(speeds, t_ns)
        for offset_ns in sorted(rng.integers(0, 83_000_000, 4).tolist()):
            watched.truth(t_ns + offset_ns)
            watched.wheel_steps(t_ns + offset_ns)
    end_ns = 40 * SECOND_NS
    assert watched.truth(end_ns) == alone.truth(end_ns)
    assert watched.contacts == alone.contacts > 0


def test_gain_error_belongs_to_the_robot_and_slip_to_the_moment() -> None:
    def drift_rad(slip_sd: float, gain_error_sd: float, seed: int) -> list[float]:
        robot = body(BodyFaults(slip_sd, gain_error_sd, 0.0), seed=seed)
        robot.drive(WheelSpeeds(100.0, 100.0), 0)
        headings = [robot.truth(second * SECOND_NS).theta_rad for second in range(11)]
        return [after - before for before, after in itertools.pairwise(headings)]

    constant = drift_rad(0.0, 0.015, 1)
    assert max(constant) - min(constant) < 1e-12 < abs(constant[0])
    assert drift_rad(0.0, 0.015, 2)[0] != constant[0]
    random = [drift for seed in range(40) for drift in drift_rad(0.02, 0.0, seed)]
    # Ten slots of 10 steps each, two wheels: sd = 0.02 * 1.288 mm * sqrt(10 * 2) / 53 mm.
    assert np.std(random) == pytest.approx(0.02 * 1.288e-3 * math.sqrt(20) / 0.053, rel=0.1)


def test_walls_stop_the_body_and_a_lasting_contact_counts_once() -> None:
    robot = body()
    robot.drive(WheelSpeeds(1000.0, 1000.0), 0)
    assert robot.truth(10 * SECOND_NS).x_m == WALLS.east_m - EpuckGeometry().body_radius_m
    assert robot.contacts == 1
    assert robot.wheel_steps(10 * SECOND_NS).left == 10_000, "the wheels slip and go on counting"
    robot.drive(WheelSpeeds(-1000.0, -1000.0), 10 * SECOND_NS)
    robot.truth(13 * SECOND_NS)
    assert robot.contacts == 1
    robot.truth(30 * SECOND_NS)
    assert robot.contacts == 2


def test_placed_by_hand_it_starts_there_and_walls_hold_only_inside() -> None:
    robot = body()
    robot.drive(WheelSpeeds(500.0, 500.0), 0)
    robot.truth(SECOND_NS)
    outside = Pose(WALLS.east_m + 0.1, WALLS.south_m, math.pi / 2)
    robot.place(outside)
    assert robot.truth(SECOND_NS) == outside
    assert robot.truth(2 * SECOND_NS).y_m == pytest.approx(WALLS.south_m + 500 * 0.1288e-3)
    robot.place(MIDDLE)
    assert robot.truth(60 * SECOND_NS).x_m == WALLS.east_m - EpuckGeometry().body_radius_m
    assert robot.contacts == 1


def test_time_may_start_anywhere_but_not_go_back() -> None:
    robot = body()
    start_ns = 1_790_000_000 * SECOND_NS
    robot.drive(WheelSpeeds(100.0, 100.0), start_ns)
    assert robot.wheel_steps(start_ns + SECOND_NS).right == 100
    with pytest.raises(ValueError, match="time went back"):
        robot.truth(start_ns)
