"""Wheel diameter and wheel base of a robot, from squares that it drives both ways under the tracker.

Between two rests the tracker gives how far the robot went and turned, and the counters how many steps each
wheel made. Straight legs give the length of a step; turns in place then give the wheel base:
turn = step (right - left) / base.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

import numpy as np

from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import STOPPED, EpuckGeometry, WheelSpeeds, WheelSteps
from swarm.errors import UserError
from swarm.geometry import Pose, wrap_angle_rad

LEG_M = 0.25
"""The side of a square; the compartment of the paper has room for four."""
FORWARD_M_PER_S = 0.06
TURN_RAD_PER_S = 1.2
"""Slow: wheels that slip would spoil the result."""
SETTLE_TICKS = 5
POSE_TICKS = 15
"""A rest: first the robot comes to stand, then the tracker's poses are averaged."""
LEAST_POSES = 5
LARGEST_ERROR = 0.02
"""Relative standard error; noise and slip of a sound robot give 0.003."""

Ticks = Generator[None, int, None]
Poses = Callable[[], Sequence[Pose]]
"""The tracker's poses since the last call."""


@dataclass(frozen=True)
class Leg:
    """From one rest to the next."""

    steps_left: int
    steps_right: int
    distance_m: float
    turn_rad: float


@dataclass(frozen=True)
class WheelCalibration:
    """What the legs say, each with its standard error."""

    wheel_diameter_m: float
    wheel_diameter_error_m: float
    wheel_base_m: float
    wheel_base_error_m: float


def drive_squares(
    body: Body, poses: Poses, nominal: EpuckGeometry, period_s: float
) -> Generator[None, int, list[Leg]]:
    """Drive a square to the left and one to the right: takes the time at each tick, returns the legs.

    UserError if the tracker does not see the robot.
    """
    legs: list[Leg] = []
    before = yield from _rest(body, poses)
    for way in (1.0, -1.0):
        for _ in range(4):
            for speeds, seconds in _side(nominal, way):
                yield from _drive(body, speeds, round(seconds / period_s))
                after = yield from _rest(body, poses)
                legs.append(_leg(before, after))
                before = after
    return legs


def _side(nominal: EpuckGeometry, way: float) -> tuple[tuple[WheelSpeeds, float], ...]:
    """A leg and a quarter turn, as speeds and how long they are held."""
    forward = nominal.wheel_speeds(FORWARD_M_PER_S, 0.0)
    turn = nominal.wheel_speeds(0.0, way * TURN_RAD_PER_S)
    return (forward, LEG_M / FORWARD_M_PER_S), (turn, 0.5 * math.pi / TURN_RAD_PER_S)


def _drive(body: Body, speeds: WheelSpeeds, ticks: int) -> Ticks:
    for _ in range(ticks):
        t_ns = yield
        body.wheel_steps(t_ns)
        body.drive(speeds, t_ns)


def _rest(body: Body, poses: Poses) -> Generator[None, int, tuple[WheelSteps, Pose]]:
    """The counts and the tracker's mean pose of a robot that stands."""
    yield from _drive(body, STOPPED, SETTLE_TICKS)
    poses()
    seen: list[Pose] = []
    for _ in range(POSE_TICKS):
        yield from _drive(body, STOPPED, 1)
        seen += poses()
    if len(seen) < LEAST_POSES:
        raise UserError(f"the tracker gave {len(seen)} poses in a rest: is the robot's hat in view?")
    t_ns = yield
    return body.wheel_steps(t_ns), _mean(seen)


def _mean(poses: list[Pose]) -> Pose:
    theta_rad = math.atan2(
        sum(math.sin(pose.theta_rad) for pose in poses), sum(math.cos(pose.theta_rad) for pose in poses)
    )
    count = len(poses)
    return Pose(sum(pose.x_m for pose in poses) / count, sum(pose.y_m for pose in poses) / count, theta_rad)


def _leg(before: tuple[WheelSteps, Pose], after: tuple[WheelSteps, Pose]) -> Leg:
    (steps, pose), (steps_after, pose_after) = before, after
    return Leg(
        steps_after.left - steps.left,
        steps_after.right - steps.right,
        pose_after.distance_m(pose),
        wrap_angle_rad(pose_after.theta_rad - pose.theta_rad),
    )


def calibration_of(legs: list[Leg]) -> WheelCalibration:
    """Step length from the straight legs, wheel base from the turns. UserError without either."""
    straight = [leg for leg in legs if leg.steps_left * leg.steps_right > 0]
    turns = [leg for leg in legs if leg.steps_left * leg.steps_right < 0]
    if len(straight) < 2 or len(turns) < 2:
        raise UserError("the wheels did not turn as commanded: try `robot-agent check` first")
    steps_m = np.array([2 * leg.distance_m / (leg.steps_left + leg.steps_right) for leg in straight])
    step_m = float(steps_m.mean())
    bases_m = np.array([step_m * (leg.steps_right - leg.steps_left) / leg.turn_rad for leg in turns])
    for name, values in (("straight legs", steps_m), ("turns", bases_m)):
        if _standard_error(values) > LARGEST_ERROR * float(values.mean()):
            raise UserError(f"the {name} do not agree: did the robot touch something, do its wheels slip?")
    diameter_m = EpuckGeometry.diameter_m(step_m)
    return WheelCalibration(
        diameter_m,
        diameter_m / step_m * _standard_error(steps_m),
        float(bases_m.mean()),
        _standard_error(bases_m),
    )


def _standard_error(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    return float(values.std(ddof=1) / math.sqrt(len(values)))
