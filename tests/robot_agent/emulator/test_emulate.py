"""`robot-agent emulate` stands alone: a robot for drivers, and for people who learn to use them."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robot_agent.drivers.epuck_driver import KINDS, opened_body
from robot_agent.drivers.kinematics import EpuckGeometry
from robot_agent.emulator.emulation import LINKS
from robot_agent.emulator.faults import Faults
from swarm.errors import UserError
from tests.support.swarm_runs import ROOT

COMMAND = [sys.executable, "-m", "robot_agent", "emulate"]


def say_nothing(*_event: str) -> None:
    pass


@pytest.mark.parametrize("link", LINKS)
def test_an_emulated_robot_says_where_it_is_and_answers(link: str, tmp_path: Path) -> None:
    """The address that it prints is the one that a driver takes."""
    places = {"serial": str(tmp_path / "robot"), "wifi": "127.0.0.1:0"}
    at = places.get(link, f"unix:{tmp_path / 'robot'}")
    command = [*COMMAND, link, "--at", at, "--json"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        said = json.loads(process.stdout.readline())
        body = opened_body(KINDS[link], said["address"], EpuckGeometry(), 1.0, say_nothing)
        identity = body.wait_for_robot()
        body.close()
        process.send_signal(signal.SIGTERM)
        assert process.wait() == 143
    assert said["link"] == link
    assert "puck" in identity or "Version 2.0" in identity


def test_an_unknown_fault_is_named_with_the_nearest() -> None:
    command = [*COMMAND, "serial", "--fault", "bannner=0.1"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "error: --fault 'bannner' is unknown; did you mean 'banner'?\n"


def test_faults_are_read_from_texts() -> None:
    assert Faults.parse(["failure=0.001", "stall_s=2"]) == Faults(failure=0.001, stall_s=2.0)
    with pytest.raises(UserError, match="takes a number"):
        Faults.parse(["failure=often"])
