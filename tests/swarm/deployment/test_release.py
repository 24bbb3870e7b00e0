"""What a machine is given: units that systemd rates as safe, credentials of its own, files from below."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from swarm.config.laboratory import Laboratory
from swarm.deployment.fleet import targets
from swarm.deployment.release import ExperimentFiles, Protection, release_files, release_id
from swarm.errors import UserError
from tests.support.swarm_runs import ROOT

UNITS = sorted((ROOT / "deploy" / "systemd").glob("*.service"))
WORST = 25
"""Tenths of systemd's exposure level: it calls 0 to 4 OK, and the agent's devices are what is left."""
LABORATORY = """[laboratory]
name = "arena"

[server]
host = "10.0.0.9"

[[robot]]
id = "r1"
host = "10.0.0.1"
user = "pi"
driver = "i2c"
address = "4"
calibration = "r1.toml"
south_west_m = [0.1, 0.1]
"""


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.stem)
def test_systemd_rates_every_unit_ok(unit: Path) -> None:
    if not shutil.which("systemd-analyze"):
        pytest.skip("needs systemd-analyze")
    words = ["systemd-analyze", "security", "--offline=true", f"--threshold={WORST}", "--no-pager", str(unit)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "OK" in done.stdout.splitlines()[-1]


def files_of(directory: Path, number: int, protection: Protection) -> dict[str, bytes]:
    (directory / "lab.toml").write_text(LABORATORY)
    (directory / "r1.toml").write_text("# a camera")
    laboratory = Laboratory.load(directory / "lab.toml")
    return release_files(targets(laboratory)[number], laboratory, protection, "/opt/swarm", {})


def test_a_board_gets_its_own_units_and_nothing_of_others(tmp_path: Path) -> None:
    for name in ("server", "tracker", "robot-r1", "operator"):
        (tmp_path / "keys" / name).mkdir(parents=True)
        (tmp_path / "keys" / name / "key.pem").write_text(name)
    found = files_of(tmp_path, 1, Protection.of(tmp_path / "keys", insecure=False))
    assert sorted(found) == [
        "agent-r1.env",
        "camera-r1.toml",
        "chrony.conf",
        "credentials/robot-r1/key.pem",
        "units/swarm-agent@.service",
    ]
    unit = found["units/swarm-agent@.service"].decode()
    assert "User=pi\n" in unit
    assert "/home/swarm" not in unit
    assert "ExecStart=/opt/swarm/current/program/bin/robot-agent experiment.toml --robot %i" in unit
    assert found["agent-r1.env"].decode().splitlines() == [
        "SWARM_ENDPOINT=tls/10.0.0.9:7447",
        "SWARM_OPTIONS=--address r1=4 --calibration camera-r1.toml "
        "--credentials /opt/swarm/current/credentials/robot-r1",
    ]
    assert b"server 10.0.0.9 iburst" in found["chrony.conf"]


def test_the_server_gets_its_own_and_the_bridge_s(tmp_path: Path) -> None:
    found = files_of(tmp_path, 0, Protection(None))
    assert found["server.env"] == b"SWARM_ENDPOINT=tcp/0.0.0.0:7447\nSWARM_OPTIONS=--insecure\n"
    assert {"bridge.env", "units/swarm-bridge.service", "units/swarm-server.service"} <= set(found)
    assert b"local stratum" in found["chrony.conf"]


def test_without_keys_somebody_has_to_say_so(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="make it with `swarm lab keys`, or say --insecure"):
        Protection.of(tmp_path / "keys", insecure=False)
    (tmp_path / "keys").mkdir()
    with pytest.raises(UserError, match="--insecure: there are keys"):
        Protection.of(tmp_path / "keys", insecure=True)
    with pytest.raises(UserError, match="robot-r1 is not there"):
        files_of(tmp_path, 1, Protection.of(tmp_path / "keys", insecure=False))


def test_the_id_tells_releases_apart_by_what_is_in_them() -> None:
    files = {"a": b"1", "b": b"2"}
    same = release_id("program", dict(reversed(files.items())), ["s"])
    assert release_id("program", files, ["s"]) == same
    assert release_id("other", files, ["s"]) != same
    assert release_id("program", {"a": b"12"}, ["s"]) != same
    assert release_id("program", files, []) != same


@pytest.mark.parametrize("named", ["/etc/passwd", "../lens.toml"])
def test_an_experiment_whose_files_are_elsewhere_is_refused(tmp_path: Path, named: str) -> None:
    file = tmp_path / "experiment.toml"
    file.write_text(f"""[run]
name = "first"
[camera]
calibration = "{named}"
[[robot]]
id = "r1"
south_west_m = [0.15, 0.3]
""")
    with pytest.raises(UserError, match="move it there"):
        ExperimentFiles.read(file)
