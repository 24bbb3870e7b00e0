"""The same experiment behind each link: an agent a robot, the bytes of its link, and the usual log."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from swarm.config.experiment import REAL_LINKS, Experiment
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
    run_server(file, tmp_path / "run", "--emulate", "--speed", "5")
    errors = stop_errors(tmp_path / "run" / "trial-000.mcap", Experiment.load(file), link)
    assert errors.p99_cm <= 0.7
    assert errors.wall_contacts == 0


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
