"""Fusion: late fixes cost nothing, noise is averaged away, and a carried robot notices."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSteps
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.navigation.pose_estimator import PoseEstimator
from swarm.geometry import Compartment, Grid, Pose, wrap_angle_rad

TICK_NS = 100_000_000
GEOMETRY = EpuckGeometry()
PERFECT = BodyFaults(slip_sd=0.0, gain_error_sd=0.0, latency_s=0.0)


class Watched:
    """A body in a wide hall and its estimator, ticked at 10 Hz, with fixes of given lateness and noise."""

    def __init__(self, faults: BodyFaults, late_ticks: int, heading_sd_rad: float, seed: int = 0) -> None:
        hall = Compartment(-50.0, -50.0, Grid(10, 10), 10.0)
        body_rng, self.rng = np.random.default_rng(seed).spawn(2)
        self.body = SimulatedBody(GEOMETRY, faults, Pose(0.0, 0.0, 3.0), hall, body_rng)
        self.estimator = PoseEstimator(GEOMETRY)
        self.late_ticks, self.heading_sd_rad = late_ticks, heading_sd_rad
        self.t_ns = 0
        self.fixes: list[tuple[Pose, int]] = []

    def tick(self, forward_m_per_s: float, turn_rad_per_s: float, heard: bool = True) -> tuple[float, float]:
        """Drive for a period; return the estimate's errors before it (m, rad), NaN without an estimate."""
        truth = self.body.truth(self.t_ns)
        noise_rad = self.rng.normal(0.0, self.heading_sd_rad)
        self.fixes.append((Pose(truth.x_m, truth.y_m, truth.theta_rad + noise_rad), self.t_ns))
        self.estimator.odometry(self.body.wheel_steps(self.t_ns), self.t_ns)
        if heard and len(self.fixes) > self.late_ticks:
            self.estimator.fix(*self.fixes[-1 - self.late_ticks])
        self.body.drive(GEOMETRY.wheel_speeds(forward_m_per_s, turn_rad_per_s), self.t_ns)
        estimate = self.estimator.pose(self.t_ns)
        self.t_ns += TICK_NS
        if estimate is None:
            return math.nan, math.nan
        return estimate.distance_m(truth), wrap_angle_rad(estimate.theta_rad - truth.theta_rad)


@pytest.mark.parametrize("late_ticks", [0, 1, 3])
def test_a_late_fix_is_carried_to_now_by_the_wheels(late_ticks: int) -> None:
    watched = Watched(PERFECT, late_ticks, heading_sd_rad=0.0)
    errors = [watched.tick(0.08, 1.5 * math.sin(0.2 * tick)) for tick in range(200)]
    known = np.array(errors[late_ticks:])
    assert np.isnan(np.array(errors[:late_ticks])).all()
    assert np.abs(known[:, 0]).max() < 1e-3, "only whole steps are counted"
    assert np.abs(known[:, 1]).max() < math.radians(0.4)


@pytest.mark.parametrize("turn_rad_per_s", [0.0, 1.2])
def test_heading_noise_of_one_degree_becomes_less_than_0_3(turn_rad_per_s: float) -> None:
    """The observer stands, or turns to follow the robot that it watches."""
    squares = []
    for seed in range(8):
        watched = Watched(BodyFaults(), 1, math.radians(1.0), seed)
        errors = [watched.tick(0.0, turn_rad_per_s * (1 if tick % 40 < 20 else -1)) for tick in range(900)]
        squares.append(np.mean(np.square([error_rad for _, error_rad in errors[200:]])))
    assert math.degrees(math.sqrt(np.mean(squares))) <= 0.3


def test_wheels_of_unequal_size_are_learned_so_that_driving_blind_works() -> None:
    errors_m = {}
    for training_ticks in (5, 1200):
        watched = Watched(BodyFaults(0.0, 0.03, 0.0), 1, math.radians(0.5), seed=2)
        for tick in range(training_ticks):
            watched.tick(0.08, 1.0 if tick % 60 < 30 else -0.4)
        for _ in range(30):
            error_m, _ = watched.tick(0.1, 0.0, heard=False)
        errors_m[training_ticks] = error_m
    assert errors_m[1200] < 0.25 * errors_m[5]
    assert errors_m[1200] < 0.01


def test_age_counts_from_the_measurement() -> None:
    estimator = PoseEstimator(GEOMETRY)
    estimator.odometry(WheelSteps(0, 0), 0)
    assert estimator.age_s(0) == math.inf
    assert estimator.pose(0) is None
    estimator.odometry(WheelSteps(0, 0), 2 * TICK_NS)
    estimator.fix(Pose(1.0, 1.0, 0.0), TICK_NS)
    assert estimator.age_s(2 * TICK_NS) == pytest.approx(0.1)
    assert estimator.pose(2 * TICK_NS) == Pose(1.0, 1.0, 0.0)


def test_old_and_repeated_fixes_are_passed_over() -> None:
    estimator = PoseEstimator(GEOMETRY)
    estimator.fix(Pose(9.0, 9.0, 0.0), 0)
    for tick in range(60):
        estimator.odometry(WheelSteps(0, 0), tick * TICK_NS)
    estimator.fix(Pose(9.0, 9.0, 0.0), 0)
    assert estimator.pose(59 * TICK_NS) is None, "older than the memory"
    estimator.fix(Pose(1.0, 1.0, 0.0), 58 * TICK_NS)
    estimator.fix(Pose(1.04, 1.0, 0.0), 58 * TICK_NS)
    estimator.fix(Pose(1.04, 1.0, 0.0), 57 * TICK_NS)
    assert estimator.pose(59 * TICK_NS) == Pose(1.0, 1.0, 0.0)


def test_a_single_far_fix_is_not_believed() -> None:
    watched = Watched(PERFECT, 0, 0.0)
    for tick in range(50):
        if tick % 10 == 5:
            watched.estimator.fix(Pose(0.5, 0.5, 0.0), watched.t_ns - TICK_NS // 2)
        error_m, _ = watched.tick(0.05, 0.0)
        assert error_m < 1e-3
    assert not watched.estimator.displaced


def test_a_robot_carried_by_hand_notices_and_starts_afresh_after_a_reset() -> None:
    watched = Watched(PERFECT, 1, 0.0)
    for _ in range(20):
        watched.tick(0.0, 0.0)
    watched.body.place(Pose(1.0, -2.0, -1.0))
    noticed = [(watched.tick(0.0, 0.0), watched.estimator.displaced)[1] for _ in range(6)]
    assert noticed == [False, False, False, True, True, True], "one late fix, then three that agree"
    assert watched.estimator.pose(watched.t_ns) == watched.body.truth(watched.t_ns)
    watched.estimator.reset()
    assert not watched.estimator.displaced
    assert watched.estimator.pose(watched.t_ns) is None
    assert watched.tick(0.0, 0.0) == (0.0, 0.0)


def test_a_small_push_is_followed_without_alarm() -> None:
    watched = Watched(PERFECT, 0, 0.0)
    for _ in range(100):
        watched.tick(0.0, 0.0)
    watched.body.place(Pose(0.02, 0.0, 3.1))
    errors = [watched.tick(0.0, 0.0) for _ in range(60)]
    assert errors[0][0] > 0.01
    assert errors[-1][0] < 0.001
    assert not watched.estimator.displaced


def test_the_past_can_be_asked_for() -> None:
    watched = Watched(PERFECT, 0, 0.0)
    for _ in range(20):
        watched.tick(0.1, 0.0)
    now, earlier = watched.estimator.pose(19 * TICK_NS), watched.estimator.pose(17 * TICK_NS - TICK_NS // 2)
    assert now is not None
    assert earlier is not None
    assert now.distance_m(earlier) == pytest.approx(0.025, abs=5e-4)
