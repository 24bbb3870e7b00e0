"""The example driver: installed as a user would, found by its name, held to the body's contract."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import pytest

from robot_agent.drivers.kinematics import EpuckGeometry, WheelSpeeds
from swarm.geometry import Pose
from tests.contracts.examiners import BODY_CHECKS, SECOND_NS, TICK_NS, BodyRig
from tests.support.swarm_runs import ROOT

START = Pose(0.06, 1.14, 0.0)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the example's package, and nothing else."""
    folder = tmp_path_factory.mktemp("driver")
    shutil.copytree(ROOT / "examples" / "own_driver", folder / "source")
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    places = ["--target", str(folder / "site"), str(folder / "source")]
    command = [sys.executable, "-m", "pip", "install", *options, *places]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "site"


@pytest.fixture
def perfect_wheels(installed: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The installed module, found through its entry point."""
    monkeypatch.syspath_prepend(installed)
    (entry,) = entry_points(group="swarm.drivers", name="perfect")
    return sys.modules[entry.load().__module__]


class PerfectRig:
    """Perfect wheels need no world but themselves."""

    def __init__(self, module: Any) -> None:
        self.geometry = EpuckGeometry()
        self.body = module.PerfectWheels(self.geometry, START)

    def run_to(self, t_ns: int) -> None:
        self.body.pose(t_ns)

    def motors_stand(self, t_ns: int) -> bool:
        stand: bool = self.body.wheel_steps(t_ns) == self.body.wheel_steps(t_ns + SECOND_NS // 100)
        return stand


@pytest.mark.parametrize("check", BODY_CHECKS, ids=lambda check: check.__name__.lstrip("_"))
def test_the_wheels_keep_the_contract(perfect_wheels: Any, check: Callable[[BodyRig, int], int]) -> None:
    check(PerfectRig(perfect_wheels), SECOND_NS)


def test_the_wheels_bring_the_robot_where_it_was_told(perfect_wheels: Any) -> None:
    """A quarter turn to the left on the spot, then 10 cm straight on."""
    geometry = EpuckGeometry()
    wheels = perfect_wheels.PerfectWheels(geometry, START)
    turning = geometry.sendable(geometry.wheel_speeds(0.0, math.pi / 2))
    for t_ns in range(0, SECOND_NS, TICK_NS):
        wheels.drive(turning, t_ns)
    turned_rad = turning.right_steps_per_s * geometry.step_m / (0.5 * geometry.wheel_base_m)
    for t_ns in range(SECOND_NS, 3 * SECOND_NS, TICK_NS):
        wheels.drive(WheelSpeeds(500.0, 500.0), t_ns)
    pose = wheels.pose(3 * SECOND_NS)
    way_m = 1000 * geometry.step_m
    assert pose.theta_rad == pytest.approx(turned_rad)
    assert pose.x_m == pytest.approx(START.x_m + way_m * math.cos(turned_rad))
    assert pose.y_m == pytest.approx(START.y_m + way_m * math.sin(turned_rad))
