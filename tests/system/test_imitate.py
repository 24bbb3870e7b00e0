"""`robot-agent imitate` as a process: what a robot drives for others to see, and what is refused."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from robot_agent.emulator.emulation import Emulation, RobotToEmulate, default_address
from robot_agent.imitation.pattern import corner_error_m
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.emulated_robot import HALL, MIDDLE
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, write_experiment

PAIR = """\
[run]
name = "pair"
[[robot]]
id = "shows"
driver = "serial"
south_west_m = [0.2, 0.2]
"""
SIMULATED = """\
[[robot]]
id = "looks"
watches = "shows"
south_west_m = [1.6, 0.2]
"""
PATTERN = "0 0.25, 90 0.15, -90 0.1"
CORNERS = [(0.0, 0.0), (0.25, 0.0), (0.25, 0.15), (0.35, 0.15)]


def imitate(file: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "robot_agent", "imitate", str(file), *options]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_a_robot_drives_a_pattern_over_its_link_without_a_tracker(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    wanted = RobotToEmulate("serial", HALL, MIDDLE)
    address = default_address("serial", tmp_path, "robot")
    with (
        Session(SessionSettings(endpoint, hub=True)),
        Emulation(wanted, address, time.monotonic_ns, np.random.default_rng(1)) as emulation,
    ):
        options = ("--connect", endpoint, f"--address=shows={address}", "--robot", "shows", "--by-wheels")
        file = write_experiment(tmp_path, PAIR)
        done = imitate(file, *options, "--pattern", PATTERN, "--json")
        with emulation.lock:
            truth = emulation.robot.truth(time.monotonic_ns())
    assert done.returncode == 0, done.stderr
    assert corner_error_m(CORNERS, json.loads(done.stdout)["driven_m"]) < 0.01
    assert (truth.x_m - MIDDLE.x_m, truth.y_m - MIDDLE.y_m) == pytest.approx(CORNERS[-1], abs=0.01)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--robot", "show"), "--robot 'show' is not in the experiment"),
        (("--robot", "shows"), "watches nobody"),
        (("--robot", "looks"), "is simulated: its camera is shown something in visits"),
        (("--robot", "shows", "--pattern", "90"), "say degrees and metres"),
    ],
)
def test_what_cannot_be_imitated_is_one_line(options: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = imitate(write_experiment(tmp_path, PAIR + SIMULATED), *options)
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1
