"""Every robot driver passes the body's contract."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, StepUnwrapper, WheelSteps
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from swarm.geometry import Compartment, Grid, Pose
from tests.contracts.examiners import BODY_CHECKS, SECOND_NS, BodyRig

WALLS = Compartment(0.0, 0.0, Grid(10, 10), 0.12)


class SimulatedRig:
    """A simulated body needs no world but itself."""

    def __init__(self) -> None:
        self.geometry = EpuckGeometry()
        rng = np.random.default_rng(1)
        self.body = SimulatedBody(self.geometry, BodyFaults(), Pose(0.6, 0.6, 0.0), WALLS, rng)

    def run_to(self, t_ns: int) -> None:
        self.body.truth(t_ns)

    def motors_stand(self, t_ns: int) -> bool:
        return self.body.wheel_steps(t_ns) == self.body.wheel_steps(t_ns + SECOND_NS)


RIGS: list[Callable[[], BodyRig]] = [
    SimulatedRig,
]


@pytest.mark.parametrize("check", BODY_CHECKS, ids=lambda check: check.__name__.lstrip("_"))
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.__name__)
def test_body_contract(rig: Callable[[], BodyRig], check: Callable[[BodyRig, int], int]) -> None:
    check(rig(), SECOND_NS)


def test_unwrapper_follows_signed_and_unsigned_counters_over_the_wrap() -> None:
    unsigned, signed = StepUnwrapper(), StepUnwrapper()
    counts = [0, 20_000, 40_000, 65_000, 90_000, 70_000, 40_000, 10_000, -15_000, -40_000]
    for count in counts:
        wrapped = count & 0xFFFF
        assert unsigned.unwrap(wrapped, -count & 0xFFFF) == WheelSteps(count, -count)
        as_signed = (wrapped + 0x8000) % 0x10000 - 0x8000
        assert signed.unwrap(as_signed, as_signed).left == count
