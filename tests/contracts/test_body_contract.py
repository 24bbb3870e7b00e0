"""Every robot driver passes the body's contract: the simulated one, and each link over its own transport."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.deadline import STOP_WITHIN_S
from robot_agent.drivers.kinematics import EpuckGeometry, StepUnwrapper, WheelSteps
from robot_agent.drivers.sim.body import BodyFaults, SimulatedBody
from swarm.geometry import Compartment, Grid, Pose
from tests.contracts.examiners import BODY_CHECKS, SECOND_NS, BodyRig
from tests.support.emulated_robot import LINKS, EmulatedRig

WALLS = Compartment(0.0, 0.0, Grid(10, 10), 0.12)


class SimulatedRig:
    """A simulated body needs no world but itself."""

    def __init__(self) -> None:
        self.geometry = EpuckGeometry()
        pose, rng = Pose(0.6, 0.6, 0.0), np.random.default_rng(1)
        self.body = SimulatedBody(self.geometry, BodyFaults(), pose, WALLS, rng, STOP_WITHIN_S)

    def run_to(self, t_ns: int) -> None:
        self.body.truth(t_ns)

    def motors_stand(self, t_ns: int) -> bool:
        """As far as a look 10 ms ahead shows."""
        return self.body.wheel_steps(t_ns) == self.body.wheel_steps(t_ns + SECOND_NS // 100)


RIGS = ["sim", *("-".join(link) for link in LINKS)]


@pytest.fixture(params=RIGS)
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[BodyRig]:
    if request.param == "sim":
        yield SimulatedRig()
        return
    link, model = request.param.split("-")
    emulated = EmulatedRig(link, model, tmp_path)
    yield emulated
    emulated.close()


@pytest.mark.parametrize("check", BODY_CHECKS, ids=lambda check: check.__name__.lstrip("_"))
def test_body_contract(rig: BodyRig, check: Callable[[BodyRig, int], int]) -> None:
    check(rig, SECOND_NS)


def test_unwrapper_follows_signed_and_unsigned_counters_over_the_wrap() -> None:
    unsigned, signed = StepUnwrapper(), StepUnwrapper()
    counts = [0, 20_000, 40_000, 65_000, 90_000, 70_000, 40_000, 10_000, -15_000, -40_000]
    for count in counts:
        wrapped = count & 0xFFFF
        assert unsigned.unwrap(wrapped, -count & 0xFFFF) == WheelSteps(count, -count)
        as_signed = (wrapped + 0x8000) % 0x10000 - 0x8000
        assert signed.unwrap(as_signed, as_signed).left == count
