"""The pre-flight of a robot: what is good, what is not, and what to do about it."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robot_agent.emulator.emulation import Emulation, RobotToEmulate, default_address
from robot_agent.emulator.faults import Faults
from tests.support.emulated_robot import HALL, LINKS, MIDDLE
from tests.support.swarm_runs import ROOT


def checked(link: str, address: str, *options: str) -> tuple[int, dict[str, dict[str, Any]], str]:
    """The exit code of `robot-agent check`, its findings by name, and what it says when it fails."""
    command = [sys.executable, "-m", "robot_agent", "check", link, address, "--json", *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    findings = json.loads(done.stdout)["checks"] if done.stdout else []
    return done.returncode, {finding["check"]: finding for finding in findings}, done.stderr


@contextmanager
def served(link: str, model: str, place: Path, faults: Faults | None = None) -> Iterator[str]:
    wanted = RobotToEmulate(link, HALL, MIDDLE, model, faults=faults or Faults())
    address = default_address(link, place, "robot")
    with Emulation(wanted, address, time.monotonic_ns, np.random.default_rng(1)) as emulation:
        yield emulation.address


def test_a_good_robot_passes(tmp_path: Path) -> None:
    assert_passes("i2c", "epuck2", tmp_path)


@pytest.mark.long
@pytest.mark.parametrize(("link", "model"), LINKS, ids=["-".join(link) for link in LINKS])
def test_a_good_robot_passes_over_every_link(link: str, model: str, tmp_path: Path) -> None:
    assert_passes(link, model, tmp_path)


def assert_passes(link: str, model: str, tmp_path: Path) -> None:
    with served(link, model, tmp_path) as address:
        code, findings, said = checked(link, address)
    assert code == 0, said
    assert len(findings) == 9
    assert not [finding for finding in findings.values() if finding["verdict"] == "bad"]
    assert "steps" in findings["left wheel"]["found"]


def test_what_is_wrong_is_named_with_its_cure(tmp_path: Path) -> None:
    faults = Faults(sag_v_per_s=0.25, banner=0.3)
    with served("serial", "epuck2", tmp_path, faults) as address:
        code, findings, said = checked("serial", address, "--stand")
    assert code == 1
    assert findings["battery"]["verdict"] == "bad"
    assert findings["battery"]["cure"] == "charge the robot"
    assert findings["link"]["verdict"] == "bad"
    assert said.strip() == "failed: 2 of 4 checks: link, battery"


def test_a_robot_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    code, findings, said = checked("spi", str(tmp_path / "nothing"), "--stand")
    assert code in (1, 2), "without spidev the extra is named"
    assert len(said.splitlines()) == 1
    assert code == 2 or "cannot open" in findings["robot"]["found"]
