"""The wheels of a robot whose true dimensions are known come out of the squares that it drives."""

from __future__ import annotations

import numpy as np
import pytest

from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from robot_agent.navigation.wheel_calibration import Leg, WheelCalibration, calibration_of, drive_squares
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.support.emulated_robot import HALL, MIDDLE

TICK_NS = 100_000_000


def calibrated(diameter_m: float, base_m: float, seed: int, *, seen: bool = True) -> WheelCalibration:
    """Squares by a slipping robot under a tracker with 1 mm and half a degree of noise."""
    body_rng, tracker_rng = np.random.default_rng(seed).spawn(2)
    true = EpuckGeometry.calibrated(diameter_m, base_m)
    body = SimulatedBody(true, BodyFaults(slip_sd=0.01, gain_error_sd=0.0), MIDDLE, HALL, body_rng)
    t_ns = TICK_NS

    def poses() -> list[Pose]:
        if not seen:
            return []
        truth, noise = body.truth(t_ns), tracker_rng.normal(0.0, (0.001, 0.001, 0.0087)).tolist()
        return [Pose(truth.x_m + noise[0], truth.y_m + noise[1], truth.theta_rad + noise[2])]

    squares = drive_squares(body, poses, EpuckGeometry(), 0.1)
    next(squares)
    while True:
        try:
            squares.send(t_ns)
        except StopIteration as driven:
            return calibration_of(driven.value)
        t_ns += TICK_NS


@pytest.mark.parametrize(("diameter_m", "base_m"), [(0.041, 0.053), (0.0402, 0.0568), (0.0415, 0.052)])
def test_the_true_dimensions_come_out(diameter_m: float, base_m: float) -> None:
    for seed in range(5):
        found = calibrated(diameter_m, base_m, seed)
        assert found.wheel_diameter_m == pytest.approx(diameter_m, rel=0.005)
        assert found.wheel_base_m == pytest.approx(base_m, rel=0.01)
        assert found.wheel_diameter_error_m < 0.0002
        assert abs(found.wheel_base_m - base_m) < 4 * found.wheel_base_error_m + 0.0001


def test_a_robot_that_meets_a_wall_is_an_error() -> None:
    legs = [Leg(2000, 2000, 0.2576, 0.0), Leg(2000, 2000, 0.1, 0.0), Leg(-300, 300, 0.0, 1.458)] * 2
    with pytest.raises(UserError, match="straight legs do not agree"):
        calibration_of(legs)


def test_a_robot_that_the_tracker_does_not_see_is_an_error() -> None:
    with pytest.raises(UserError, match="is the robot's hat in view"):
        calibrated(0.041, 0.053, 1, seen=False)
