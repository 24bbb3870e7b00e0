"""The same experiment behind each link: an agent a robot, the bytes of its link, and the usual log."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import pytest

from swarm.config.experiment import REAL_LINKS, Experiment
from swarm.messages.topics import RUN_IDENTITY
from swarm.runtime.identity import RunIdentity
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.stop_errors import stop_errors
from tests.support.swarm_runs import (
    COMPARTMENT_PITCH_M,
    ROOT,
    messages,
    run_server,
    server_command,
    write_experiment,
)

PATH = json.dumps([["SE"] * 5])


def emulated_text(drivers: tuple[str, ...], moves: int) -> str:
    """An experiment with a learner behind each of the drivers."""
    lines = ["[run]", 'name = "links"', f"moves = {moves}", "[arena]", "width_m = 13.0"]
    for number, driver in enumerate(drivers):
        lines += ["[[robot]]", f'id = "{driver}"', f'driver = "{driver}"', 'condition = "given"']
        lines += [f"south_west_m = [{number * COMPARTMENT_PITCH_M:.1f}, 0.0]", f"paths = {PATH}"]
    return "\n".join(lines) + "\n"


def test_robots_behind_every_link_and_a_simulated_one_learn_in_one_run(tmp_path: Path) -> None:
    drivers = (*REAL_LINKS, "sim")
    file = write_experiment(tmp_path, emulated_text(drivers, moves=8))
    run_server(file, tmp_path / "run", "--emulate", "--speed", "2")
    log = tmp_path / "run" / "trial-000.mcap"
    for driver in drivers:
        assert sum(robot == driver for robot, _ in messages(log, "move")) == 8
        errors = stop_errors(log, Experiment.load(file), driver)
        assert errors.worst_cm < 1.0
        assert errors.wall_contacts == 0
    told = {robot: event.text for robot, event in messages(log, "event") if event.name == "robot"}
    assert set(told) == set(REAL_LINKS)
    assert "Version 2.0" in told["serial"]
    volts = {robot: status.battery_v for robot, status in messages(log, "status")}
    assert volts["wifi"] == pytest.approx(4.1, abs=0.01)
    assert volts["sim"] == 0.0


@pytest.mark.long
@pytest.mark.parametrize("link", REAL_LINKS)
def test_three_hundred_moves_over_each_link_end_where_they_should(link: str, tmp_path: Path) -> None:
    file = write_experiment(tmp_path, emulated_text((link,), moves=300))
    run_server(file, tmp_path / "run", "--emulate", "--speed", "3")
    errors = stop_errors(tmp_path / "run" / "trial-000.mcap", Experiment.load(file), link)
    assert errors.p99_cm <= 0.7
    assert errors.wall_contacts == 0


@pytest.mark.long
def test_wheels_are_calibrated_over_a_link_under_the_running_tracker(tmp_path: Path) -> None:
    """Hub, tracker bridge, emulator and calibration, each a process of its own."""
    text = emulated_text(("serial",), moves=1) + "[body]\ngain_error_sd = 0.0\n"
    text = text.replace("width_m = 13.0", "width_m = 13.0\nheight_m = 13.0\ncell_m = 1.0")
    file, endpoint = write_experiment(tmp_path, text), free_endpoint()
    at = f"--address=serial={tmp_path / 'robot'}"
    pace = ("--connect", endpoint, "--speed", "3", "--started-ns", str(time.monotonic_ns()))
    with Session(SessionSettings(endpoint, hub=True)) as hub, ExitStack() as ending:
        hub.answer(RUN_IDENTITY, RunIdentity.of(Experiment.load(file), 0, "0123456789ab").pack())
        for words in (["tracker_bridge"], ["robot_agent", "emulate-robots"]):
            command = [sys.executable, "-m", *words, str(file), *pace, *([at] if len(words) > 1 else [])]
            ending.callback(ending.enter_context(subprocess.Popen(command, cwd=ROOT)).kill)
        command = [sys.executable, "-m", "robot_agent", "calibrate", "wheels", str(file), *pace, at]
        command += ["--robot", "serial", "--json"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    print(found)
    assert found["wheel_diameter_m"] == pytest.approx(0.041, rel=0.01)
    assert found["wheel_base_m"] == pytest.approx(0.053, rel=0.02)


@pytest.mark.parametrize(
    ("driver", "options", "says"),
    [
        ("wifi", (), "a simulation needs --emulate and --speed X"),
        ("wifi", ("--emulate",), "--emulate needs --speed X"),
        ("sim", ("--emulate", "--speed", "2"), "no robot's driver is one of serial, wifi, i2c, spi"),
    ],
)
def test_a_run_that_cannot_be_emulated_says_why(
    driver: str, options: tuple[str, ...], says: str, tmp_path: Path
) -> None:
    file = write_experiment(tmp_path, emulated_text((driver,), moves=1))
    command = server_command(file, tmp_path / "run", *options)
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1
