"""Drivers are found by name: those built in, and those that an installed package brings."""

from __future__ import annotations

import sys
from dataclasses import replace
from importlib.machinery import ModuleSpec
from pathlib import Path

import numpy as np
import pytest

from robot_agent.drivers.interfaces import DriverParts
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.drivers.registry import make_driver
from swarm.config.experiment import Experiment
from swarm.errors import UserError
from tests.support.local_node import LocalNode
from tests.support.swarm_runs import experiment_text, learners, write_experiment

THEIR_DRIVER = """
class TheirDriver:
    def __init__(self, parts):
        self.robot = parts.robot.id
"""


def parts(place: Path, driver: str) -> DriverParts:
    text = experiment_text(learners(1)) + f'driver = "{driver}"\n'
    experiment = Experiment.load(write_experiment(place, text))
    node, rng = LocalNode(), np.random.default_rng(1)
    return DriverParts(experiment, experiment.robot[0], EpuckGeometry(), node, lambda _: rng)


def test_a_package_brings_its_own_driver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The package is really on the path, with its metadata, as pip would leave it."""
    (tmp_path / "their_robot.py").write_text(THEIR_DRIVER)
    metadata = tmp_path / "their_robot-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: their-robot\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[swarm.drivers]\ntheirs = their_robot:TheirDriver\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert vars(make_driver(parts(tmp_path, "theirs"))) == {"robot": "r0"}


def test_an_unknown_driver_is_named_with_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="did you mean 'serial'"):
        make_driver(parts(tmp_path, "serail"))


def test_a_real_link_cannot_take_part_in_a_lockstep(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="keeps its own time; use --emulate and --speed X"):
        make_driver(replace(parts(tmp_path, "wifi"), lockstep=True))


def test_a_robot_without_an_address_is_told_what_one_looks_like(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no address, for instance /dev/ttyACM0"):
        make_driver(parts(tmp_path, "serial"))


class Refuse:
    """An interpreter in which a package is not installed."""

    def __init__(self, package: str) -> None:
        self._package = package

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:  # noqa: ARG002
        if name == self._package:
            raise ModuleNotFoundError(name)
        return None


@pytest.mark.parametrize(("driver", "package"), [("serial", "serial"), ("i2c", "smbus2"), ("spi", "spidev")])
def test_a_missing_package_is_an_error_that_names_the_extra(
    driver: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, package, raising=False)
    monkeypatch.setattr(sys, "meta_path", [Refuse(package), *sys.meta_path])
    with pytest.raises(UserError, match=rf"pip install 'swarm-runtime\[{driver}\]'"):
        make_driver(replace(parts(tmp_path, driver), address="/dev/robot"))
