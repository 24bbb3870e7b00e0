"""Every tracker backend passes the backend's contract."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from swarm.config.experiment import TrackerSettings
from swarm.messages import swarm_pb2 as pb
from swarm.messages.header import Header
from swarm.runtime.subscription import Received
from tests.contracts.examiners import BACKEND_CHECKS, SECOND_NS, BackendRig
from tracker_bridge.backends.sim import SimulatedTracker

TRUTHS = {
    "a": pb.Truth(x_m=1.0, y_m=0.5, theta_rad=math.pi / 2),
    "b": pb.Truth(x_m=2.0, y_m=1.5, theta_rad=math.pi),
}


class SimulatedRig:
    """The simulated tracker, to which robots that stand tell the truth."""

    tolerance_m = 0.01
    tolerance_rad = 0.06

    def __init__(self) -> None:
        self._told: list[Received[pb.Truth]] = []
        self._sequence = 0
        self.backend = SimulatedTracker(TrackerSettings(), self._take, lambda _: np.random.default_rng(1))

    def run_to(self, t_ns: int) -> None:
        self._sequence += 1
        header = Header(1, self._sequence, t_ns)
        self._told.extend(Received(robot, header, truth) for robot, truth in TRUTHS.items())

    def _take(self) -> list[Received[pb.Truth]]:
        told, self._told = self._told, []
        return told


RIGS: list[Callable[[], BackendRig]] = [
    SimulatedRig,
]


@pytest.mark.parametrize("check", BACKEND_CHECKS, ids=lambda check: check.__name__.lstrip("_"))
@pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.__name__)
def test_backend_contract(rig: Callable[[], BackendRig], check: Callable[[BackendRig, int], None]) -> None:
    check(rig(), SECOND_NS)
