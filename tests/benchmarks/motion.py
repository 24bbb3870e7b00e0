"""A thousand moves from cell to cell: their time, their stop error, and what each layer costs.

Run with `python -m tests.benchmarks.motion`; prints one JSON line.
"""

from __future__ import annotations

import json
import math
import time
from dataclasses import asdict
from typing import Any

import numpy as np

from robot_agent.drivers.sim.body import BodyFaults
from robot_agent.navigation.motion import MotionSettings
from tests.support.moving_robot import (
    COMPARTMENT,
    TICK_NS,
    MoveFigures,
    MovingRobot,
    TrackerFaults,
    random_moves,
)

MOVES = 1000

HARD_BODY = BodyFaults(slip_sd=0.03, gain_error_sd=0.04)
HARD_TRACKER = TrackerFaults(position_sd_m=0.003, heading_sd_rad=math.radians(1.5))
OFTEN_LOST = TrackerFaults(losses_per_s=1 / 15)
DRIVE_ON = MotionSettings(stale_pose_s=5.0)


def moves(robot: MovingRobot, seed: int) -> dict[str, float]:
    return _rounded(random_moves(robot, MOVES, np.random.default_rng(seed)))


def _rounded(figures: MoveFigures) -> dict[str, float]:
    return {name: round(value, 3) for name, value in asdict(figures).items()}


def drives_back(seed: int, drives: int = 20) -> dict[str, float]:
    """Long drives between the start cell and the goal cell."""
    robot = MovingRobot(seed)
    ends = [COMPARTMENT.centre(COMPARTMENT.grid.goal), COMPARTMENT.centre(COMPARTMENT.grid.start)]
    results = [robot.drive_to(*ends[drive % 2]) for drive in range(drives)]
    return {
        "mean_s": round(float(np.mean([duration_s for duration_s, _ in results])), 2),
        "worst_error_cm": round(100.0 * max(error_m for _, error_m in results), 3),
        "contacts": robot.body.contacts,
    }


def layer_costs_us(seed: int, ticks: int = 20_000) -> dict[str, float]:
    """Thread time of each layer in a tick, less the cost of reading the clock; smallest of five rounds."""
    robot = MovingRobot(seed)
    corners = [COMPARTMENT.centre(state) for state in (99, 0, 90, 9)]
    rounds = [_layer_round_us(robot, corners, ticks // 5) for _ in range(5)]
    return {layer: round(min(costs[layer] for costs in rounds), 2) for layer in rounds[0]}


def _layer_round_us(robot: MovingRobot, corners: list[tuple[float, float]], ticks: int) -> dict[str, float]:
    clock = time.thread_time
    body_s = fusion_s = motion_s = clock_s = 0.0
    robot.motion.go_to(*corners[0])
    for tick in range(ticks):
        if robot.motion.arrived:
            robot.motion.go_to(*corners[tick % len(corners)])
        t0, t1 = clock(), clock()
        steps = robot.body.wheel_steps(robot.t_ns)
        robot.body.truth(robot.t_ns)
        t2 = clock()
        fixes = robot.tracker.fixes(robot.body.truth, robot.t_ns)
        before_fusion = clock()
        robot.estimator.odometry(steps, robot.t_ns)
        for fix in fixes:
            robot.estimator.fix(*fix)
        pose, age_s = robot.estimator.pose(robot.t_ns), robot.estimator.age_s(robot.t_ns)
        t3 = clock()
        speeds = robot.motion.step(pose, robot.t_ns, age_s)
        t4 = clock()
        robot.body.drive(speeds, robot.t_ns)
        t5 = clock()
        robot.t_ns += TICK_NS
        clock_s += t1 - t0
        body_s += (t2 - t1) + (t5 - t4) - 2 * (t1 - t0)
        fusion_s += t3 - before_fusion - (t1 - t0)
        motion_s += t4 - t3 - (t1 - t0)
    micro = 1e6 / ticks
    return {
        "body": body_s * micro,
        "fusion": fusion_s * micro,
        "motion": motion_s * micro,
        "reading_the_clock": clock_s * micro,
    }


def main() -> None:
    figures: dict[str, Any] = {
        "benchmark": "motion",
        "moves": MOVES,
        "nominal": moves(MovingRobot(1), 1),
        "tracker_37_ms_before_the_tick": moves(MovingRobot(2, None, TrackerFaults(early_s=0.037)), 2),
        "latency_unknown_120_ms": moves(MovingRobot(3, BodyFaults(latency_s=0.12)), 3),
        "lost_every_15_s": moves(MovingRobot(4, None, OFTEN_LOST), 4),
        "lost_every_15_s_drive_on": moves(MovingRobot(4, None, OFTEN_LOST, DRIVE_ON), 4),
        "slip_x3_gain_4_percent_tracker_x3": moves(MovingRobot(5, HARD_BODY, HARD_TRACKER), 5),
        "drive_back": drives_back(6),
        "layer_us_per_tick": layer_costs_us(7),
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
