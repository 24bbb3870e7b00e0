"""The e-puck's wheel arithmetic."""

from __future__ import annotations

import math

import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds


def test_forward_and_turning_speed_become_wheel_speeds() -> None:
    speeds = EpuckGeometry().wheel_speeds(0.1288, 0.0)
    assert (speeds.left_steps_per_s, speeds.right_steps_per_s) == pytest.approx((1000.0, 1000.0))
    spin = EpuckGeometry(wheel_base_m=0.0515).wheel_speeds(0.0, 1.0)
    assert (spin.left_steps_per_s, spin.right_steps_per_s) == pytest.approx((-199.92, 199.92), abs=0.02)


def test_too_fast_is_slowed_on_the_same_curve_and_in_whole_steps() -> None:
    geometry = EpuckGeometry()
    assert geometry.sendable(WheelSpeeds(1500.0, 750.0)) == WheelSpeeds(1000.0, 500.0)
    assert geometry.sendable(WheelSpeeds(-3000.0, 1000.0)) == WheelSpeeds(-1000.0, 333.0)
    assert geometry.sendable(WheelSpeeds(12.4, -12.6)) == WheelSpeeds(12.0, -13.0)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_speed_that_is_not_finite_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="must be finite"):
        EpuckGeometry().sendable(WheelSpeeds(bad, 0.0))
