"""The obstacle reflex, with the echoes that an emulated robot sends over its link."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.interfaces import Body
from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from robot_agent.drivers.proximity import distance_m, echo
from robot_agent.drivers.reflex import with_reflex
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from swarm.errors import UserError
from swarm.geometry import Pose
from tests.support.emulated_robot import HALL, LINKS, MIDDLE, EmulatedRig

TICK_NS = 100_000_000
FAST = WheelSpeeds(700.0, 700.0)
BEFORE_WALL_M = 0.15
TOUCHES_M = 0.035
"""The robot's radius."""


def driven_towards_the_wall(rig: EmulatedRig, body: Body, speeds: WheelSpeeds, theta_rad: float) -> float:
    """How far the robot's edge ends from the east wall after four seconds, from 15 cm before it."""
    rig.emulation.robot.place(Pose(HALL.east_m - BEFORE_WALL_M - TOUCHES_M, 6.0, theta_rad))
    for _ in range(40):
        body.wheel_steps(rig.clock.t_ns)
        body.drive(speeds, rig.clock.t_ns)
        rig.run_to(rig.clock.t_ns + TICK_NS)
    with rig.emulation.lock:
        truth = rig.emulation.robot.truth(rig.clock.t_ns)
    return HALL.east_m - truth.x_m - TOUCHES_M


@pytest.mark.parametrize(("link", "model"), LINKS, ids=["-".join(link) for link in LINKS])
@pytest.mark.parametrize(("speeds", "theta_rad"), [(FAST, 0.0), (WheelSpeeds(-400.0, -400.0), np.pi)])
def test_a_robot_stops_before_a_wall(
    link: str, model: str, speeds: WheelSpeeds, theta_rad: float, tmp_path: Path
) -> None:
    rig = EmulatedRig(link, model, tmp_path)
    off_m = driven_towards_the_wall(rig, with_reflex(rig.body, 0.05), speeds, theta_rad)
    contacts = rig.emulation.robot.wall_contacts
    rig.close()
    assert contacts == 0
    assert 0.005 < off_m < 0.06


def test_without_the_setting_it_drives_on(tmp_path: Path) -> None:
    rig = EmulatedRig("serial", "epuck2", tmp_path)
    assert with_reflex(rig.body, 0.0) is rig.body
    assert driven_towards_the_wall(rig, rig.body, FAST, 0.0) == pytest.approx(0.0, abs=1e-6)
    rig.close()


def test_a_robot_before_a_wall_may_turn_and_back_away(tmp_path: Path) -> None:
    rig = EmulatedRig("serial", "epuck2", tmp_path)
    body = with_reflex(rig.body, 0.03)
    off_m = driven_towards_the_wall(rig, body, FAST, 0.0)
    body.wheel_steps(rig.clock.t_ns)
    turning = body.drive(WheelSpeeds(100.0, 300.0), rig.clock.t_ns)
    assert turning.left_steps_per_s == pytest.approx(-turning.right_steps_per_s)
    backing = body.drive(WheelSpeeds(-200.0, -200.0), rig.clock.t_ns)
    rig.close()
    assert off_m < 0.04
    assert backing.left_steps_per_s < -190


def test_echoes_and_distances_are_each_others_inverse() -> None:
    assert [distance_m(echo(at_m)) for at_m in (0.0, 0.012, 0.03, 0.055)] == pytest.approx(
        [0.0, 0.012, 0.03, 0.055], abs=1e-3
    )
    assert distance_m(0) == 0.06


def test_a_driver_without_sensors_is_refused() -> None:
    body = SimulatedBody(EpuckGeometry(), BodyFaults(), MIDDLE, HALL, np.random.default_rng(1))
    with pytest.raises(UserError, match="needs proximity sensors"):
        with_reflex(body, 0.02)
