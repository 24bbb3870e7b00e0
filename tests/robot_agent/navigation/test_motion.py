"""Motion from cell to cell: exact, steady in time, clear of the walls, and standing when it is blind."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds
from robot_agent.drivers.sim.body import BodyFaults
from robot_agent.navigation.motion import Motion, MotionSettings
from swarm.geometry import Pose, wrap_angle_rad
from tests.support.moving_robot import COMPARTMENT, TICK_NS, MovingRobot, Tracker, TrackerFaults, random_moves

SECOND_NS = 1_000_000_000
NEVER_LOST = TrackerFaults(missing=0.0, losses_per_s=0.0)


def test_moves_take_2_2_to_2_5_s_and_end_within_0_7_cm_clear_of_the_walls() -> None:
    figures = random_moves(MovingRobot(11), 1000, np.random.default_rng(11))
    assert 2.2 <= figures.mean_s <= 2.5
    assert figures.p99_error_cm <= 0.7
    assert figures.contacts == 0
    assert figures.stalled > 0.01, "the losses of the tracker are part of the trial"


def test_a_robot_three_times_worse_still_stops_well() -> None:
    bad_body = BodyFaults(slip_sd=0.03, gain_error_sd=0.04)
    bad_tracker = TrackerFaults(position_sd_m=0.003, heading_sd_rad=math.radians(1.5))
    figures = random_moves(MovingRobot(12, bad_body, bad_tracker), 300, np.random.default_rng(12))
    assert figures.p99_error_cm <= 0.8
    assert figures.contacts == 0


@pytest.mark.parametrize("latency_s", [0.0, 0.12])
def test_a_latency_that_the_settings_do_not_know_costs_no_contact(latency_s: float) -> None:
    figures = random_moves(MovingRobot(13, BodyFaults(latency_s=latency_s)), 100, np.random.default_rng(13))
    assert figures.p99_error_cm <= 0.7
    assert figures.contacts == 0


def test_drives_back_from_the_goal_to_the_start() -> None:
    robot, grid = MovingRobot(14), COMPARTMENT.grid
    robot.drive_to(*COMPARTMENT.centre(grid.goal))
    duration_s, error_m = robot.drive_to(*COMPARTMENT.centre(grid.start))
    assert 15.0 < duration_s < 22.0
    assert error_m < 0.007
    assert robot.body.contacts == 0


def test_drives_on_by_odometry_until_the_pose_is_stale_then_stands_and_resumes() -> None:
    robot = MovingRobot(15, None, NEVER_LOST)
    x_m, y_m = COMPARTMENT.centre(9)
    robot.motion.go_to(x_m, y_m)
    for _ in range(20):
        robot.tick()
    robot.tracker = Tracker(TrackerFaults(missing=1.0), np.random.default_rng(0))
    moving = []
    for _ in range(30):
        before = robot.body.truth(robot.t_ns)
        robot.tick()
        moving.append(robot.body.truth(robot.t_ns).distance_m(before) > 1e-6)
    assert moving == [True] * 10 + [False] * 20, "fixes are up to a tick old when the tracker falls silent"
    assert robot.motion.stalled
    assert not robot.motion.arrived
    robot.tracker = Tracker(NEVER_LOST, np.random.default_rng(0))
    while not robot.motion.arrived:
        robot.tick()
    end = robot.body.truth(robot.t_ns)
    assert math.hypot(end.x_m - x_m, end.y_m - y_m) < 0.007


@pytest.mark.parametrize("theta_rad", [math.pi, -3.0, 0.02, math.pi / 2])
def test_turns_to_a_heading_in_place(theta_rad: float) -> None:
    robot = MovingRobot(17, None, NEVER_LOST)
    start = robot.body.truth(robot.t_ns)
    robot.motion.turn_to(theta_rad)
    for _ in range(30):
        robot.tick()
    end = robot.body.truth(robot.t_ns)
    assert robot.motion.arrived
    assert abs(wrap_angle_rad(end.theta_rad - theta_rad)) < math.radians(2.5)
    assert end.distance_m(start) < 0.002


def test_stop_gives_the_leg_up() -> None:
    robot = MovingRobot(18, None, NEVER_LOST)
    robot.motion.go_to(*COMPARTMENT.centre(5))
    for _ in range(12):
        robot.tick()
    robot.motion.stop()
    robot.tick()
    standing = robot.body.truth(robot.t_ns)
    for _ in range(10):
        robot.tick()
    assert robot.body.truth(robot.t_ns) == standing
    assert not robot.motion.arrived


def test_a_robot_already_there_arrives_after_the_pause() -> None:
    robot = MovingRobot(19, None, NEVER_LOST)
    robot.drive_to(*COMPARTMENT.centre(11))
    duration_s, _ = robot.drive_to(*COMPARTMENT.centre(11))
    assert duration_s <= 0.6


def test_without_a_pose_or_a_leg_the_wheels_stand() -> None:
    motion = Motion(MotionSettings(), EpuckGeometry())
    assert motion.step(Pose(0.0, 0.0, 0.0), 0) == STOPPED
    motion.go_to(1.0, 1.0)
    assert motion.step(None, TICK_NS) == STOPPED
    assert motion.stalled
    assert motion.step(Pose(0.0, 0.0, 0.0), 2 * TICK_NS, age_s=1.01) == STOPPED
    assert motion.step(Pose(0.0, 0.0, 0.0), 3 * TICK_NS, age_s=0.99) != STOPPED


def test_speeds_and_accelerations_stay_within_the_settings() -> None:
    settings = MotionSettings(drive_acceleration_m_per_s2=0.3, turn_acceleration_rad_per_s2=10.0)
    robot = MovingRobot(20, None, NEVER_LOST, settings)
    robot.motion.go_to(*COMPARTMENT.centre(77))
    forward_m_per_s, turn_rad_per_s = [0.0], [0.0]
    while not robot.motion.arrived:
        forward, turn = _twist(robot.tick())
        forward_m_per_s.append(forward)
        turn_rad_per_s.append(turn)
    rounding = 1.01
    assert 0.099 < max(forward_m_per_s) < 0.1 * rounding
    assert max(map(abs, turn_rad_per_s)) < 3.0 * rounding
    assert max(map(abs, np.diff(forward_m_per_s))) < 0.3 * settings.period_s * 1.5
    turning_in_place = [
        turn for turn, forward in zip(turn_rad_per_s, forward_m_per_s, strict=True) if not forward
    ]
    assert min(np.diff(turning_in_place)) > -10.0 * settings.period_s * rounding


def _twist(speeds: WheelSpeeds) -> tuple[float, float]:
    left_m_per_s = speeds.left_steps_per_s * EpuckGeometry().step_m
    right_m_per_s = speeds.right_steps_per_s * EpuckGeometry().step_m
    return 0.5 * (left_m_per_s + right_m_per_s), (right_m_per_s - left_m_per_s) / EpuckGeometry().wheel_base_m
