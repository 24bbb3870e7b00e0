"""Dead reckoning agrees with the wheels' geometry and remembers the recent past."""

from __future__ import annotations

import math

import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSteps
from robot_agent.navigation.odometry import Odometry

TICK_NS = 100_000_000
GEOMETRY = EpuckGeometry()


def test_a_full_circle_ends_where_it_began() -> None:
    odometry = Odometry(GEOMETRY, memory_s=1.0)
    turn_steps = math.tau * GEOMETRY.wheel_base_m / GEOMETRY.step_m
    for part in range(101):
        left = round(part * 20)
        odometry.advance(WheelSteps(left, round(left + part / 100 * turn_steps)), part * TICK_NS)
    end = odometry.newest
    assert end.theta_rad == pytest.approx(math.tau, abs=0.003)
    assert math.hypot(end.x_m, end.y_m) < 1e-3
    assert end.left_m == pytest.approx(2000 * GEOMETRY.step_m)


def test_the_first_reading_is_where_counting_starts() -> None:
    odometry = Odometry(GEOMETRY, memory_s=1.0)
    assert odometry.advance(WheelSteps(12_345, -99), 0) == (0.0, 0.0)
    assert odometry.advance(WheelSteps(12_355, -89), TICK_NS) == pytest.approx((1.288e-3, 1.288e-3))


def test_scales_lengthen_the_steps_from_now_on() -> None:
    odometry = Odometry(GEOMETRY, memory_s=1.0)
    odometry.advance(WheelSteps(0, 0), 0)
    odometry.advance(WheelSteps(1000, 1000), TICK_NS)
    odometry.left_scale = odometry.right_scale = 1.02
    odometry.advance(WheelSteps(2000, 2000), 2 * TICK_NS)
    assert odometry.newest.x_m == pytest.approx(0.1288 * (1 + 1.02))


def test_looks_back_between_readings_and_no_further_than_its_memory() -> None:
    odometry = Odometry(GEOMETRY, memory_s=0.5)
    assert odometry.at(0) is None
    for tick in range(20):
        odometry.advance(WheelSteps(100 * tick, 100 * tick), tick * TICK_NS)
    between = odometry.at(1_725_000_000)
    assert between is not None
    assert between.x_m == pytest.approx(1725 * GEOMETRY.step_m)
    assert between.t_ns == 1_725_000_000
    assert odometry.at(99 * TICK_NS) == odometry.newest
    assert odometry.at(1_300_000_000) is None
