"""Whether an experiment fits a laboratory: what both say of a robot must be the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from swarm.cli.app import app

LABORATORY = """[laboratory]
name = "arena"

[server]
host = "10.0.0.9"

[tracker]
host = "10.0.0.8"
backend = "natnet"

[[robot]]
id = "r1"
host = "10.0.0.1"
driver = "i2c"
skirt = "blue"
wheel_base_m = 0.0532
south_west_m = [0.15, 0.3]
"""
EXPERIMENT = """[run]
name = "first"
moves = 300

[tracker]
backend = "natnet"

[[robot]]
id = "r1"
driver = "i2c"
skirt = "blue"
wheel_base_m = 0.0532
south_west_m = [0.15, 0.3]
"""


def bad_findings(directory: Path, laboratory: str, experiment: str) -> list[str]:
    """What `swarm lab check` finds bad, and by the exit code thinks bad."""
    (directory / "lab.toml").write_text(laboratory)
    (directory / "experiment.toml").write_text(experiment)
    call = ["lab", "check", str(directory / "lab.toml"), str(directory / "experiment.toml"), "--json"]
    done = CliRunner().invoke(app, call)
    found = json.loads(done.output)["findings"]
    bad = [f"{finding['about']}: {finding['found']}" for finding in found if finding["level"] == "bad"]
    assert done.exit_code == bool(bad)
    return bad


def test_an_experiment_that_fits(tmp_path: Path) -> None:
    assert bad_findings(tmp_path, LABORATORY, EXPERIMENT) == []


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ('"i2c"', '"spi"', "robot r1: driver is 'i2c' in the laboratory and 'spi' in the experiment"),
        ('"blue"', '"red"', "robot r1: skirt is 'blue'"),
        ("0.0532", "0.053", "robot r1: wheel_base_m is 0.0532"),
        ("[0.15, 0.3]", "[0.15, 0.4]", "robot r1: south_west_m is (0.15, 0.3)"),
        ('"natnet"', '"vicon"', "tracker: backend is 'natnet'"),
        ('"r1"', '"r7"', "robot r7: is in the experiment and not in the laboratory"),
    ],
)
def test_what_does_not_fit_is_told(tmp_path: Path, right: str, wrong: str, said: str) -> None:
    (found,) = bad_findings(tmp_path, LABORATORY, EXPERIMENT.replace(right, wrong))
    assert found.startswith(said)


def test_a_driver_that_nobody_knows_is_bad_without_an_experiment_too(tmp_path: Path) -> None:
    wrong = LABORATORY.replace('"i2c"', '"i2d"')
    found = bad_findings(tmp_path, wrong, EXPERIMENT)
    assert found[0] == "driver of r1: 'i2d' is unknown"


def test_init_writes_a_file_that_is_good_and_overwrites_nothing(tmp_path: Path) -> None:
    call = ["lab", "init", "--out", str(tmp_path / "new")]
    assert CliRunner().invoke(app, call).exit_code == 0
    assert CliRunner().invoke(app, ["lab", "check", str(tmp_path / "new" / "lab.toml")]).exit_code == 0
    again = CliRunner().invoke(app, call)
    assert "nothing is overwritten" in str(again.exception)
