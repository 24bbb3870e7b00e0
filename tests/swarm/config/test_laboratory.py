"""Laboratory files: what is written is read, and what would be something else further on is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from swarm.config.laboratory import Laboratory, Services
from swarm.errors import UserError
from tests.support.swarm_runs import ROOT

GOOD = """[laboratory]
name = "arena"

[server]
host = "server.lab"

[policies]
services = "supervised"

[[robot]]
id = "r1"
host = "10.0.0.1"
driver = "i2c"
calibration = "cameras/r1.toml"
south_west_m = [0.1, 0.1]

[[robot]]
id = "r2"
host = "10.0.0.2"
driver = "wifi"
south_west_m = [1.6, 0.1]
"""


def load(directory: Path, text: str) -> Laboratory:
    (directory / "cameras").mkdir()
    (directory / "cameras" / "r1.toml").write_text("")
    (directory / "lab.toml").write_text(text)
    return Laboratory.load(directory / "lab.toml")


def test_a_good_file_and_its_defaults(tmp_path: Path) -> None:
    laboratory = load(tmp_path, GOOD)
    assert laboratory.policies.services is Services.SUPERVISED
    assert laboratory.robot_named("r1").calibration == tmp_path / "cameras" / "r1.toml"
    assert laboratory.robot_named("r2").login == ("swarm", "10.0.0.2", 22)
    assert laboratory.bridge is laboratory.server, "no [tracker]: the server hosts the bridge"
    assert laboratory.server_address == "server.lab:7447"


def test_an_address_with_colons_gets_brackets(tmp_path: Path) -> None:
    assert load(tmp_path, GOOD.replace("server.lab", "fd00::1")).server_address == "[fd00::1]:7447"


@pytest.mark.parametrize(
    ("right", "wrong", "line", "said"),
    [
        ('"10.0.0.1"', '"-oProxyCommand=reboot"', 12, "'host' is '-oProxyCommand=reboot'; it may have"),
        ('"10.0.0.1"', '"10.0.0.1; reboot"', 12, "'host' is '10.0.0.1; reboot'"),
        ('"10.0.0.1"', '"10.0.0.1\\n"', 12, "'host'"),
        ('driver = "i2c"', 'driver = "i2c"\nuser = "$(id)"', 14, "'user' is '$(id)'"),
        ('driver = "i2c"', 'driver = "i2c"\nuser = "root@other"', 14, "'user'"),
        ('driver = "i2c"', 'driver = "i2c"\ndirectory = "../etc"', 14, "'directory'"),
        ('driver = "i2c"', 'driver = "i2c"\ndirectory = "a b"', 14, "'directory'"),
        ('driver = "i2c"', 'driver = "i2c"\ndirectory = "a%h"', 14, "'directory'"),
        ('driver = "i2c"', 'driver = "i2c"\npython = "python3 -c x"', 14, "'python'"),
        ('driver = "i2c"', 'driver = "i2c"\naddress = "4 --state /etc"', 14, "'address'"),
        ('driver = "i2c"', 'driver = "i2c"\naddress = "$HOME"', 14, "'address'"),
        ('"r1"', '"r1/../r2"', 11, "an id starts with"),
        ('"r1"', '"run"', 11, "keys that name no robot"),
        ('"r2"', '"r1"', 18, "two robots are called 'r1'"),
        ('cameras/r1.toml"', 'cameras/r2.toml"', 14, "there is no such file"),
        ('"10.0.0.2"', '"10.0.0.1"\ndirectory = "other"', 20, "'directory' of swarm@10.0.0.1"),
        ('"supervised"', '"supervisd"', 8, "did you mean 'supervised'?"),
        ("driver =", "drvier =", 13, "unknown key 'drvier'; did you mean 'driver'?"),
        ('name = "arena"', 'name = "The arena"', 2, "an id starts with"),
    ],
)
def test_every_wrong_file_is_told_with_its_line(
    tmp_path: Path, right: str, wrong: str, line: int, said: str
) -> None:
    with pytest.raises(UserError) as refused:
        load(tmp_path, GOOD.replace(right, wrong, 1))
    assert str(refused.value).startswith(f"{tmp_path / 'lab.toml'}:{line}: ")
    assert said in str(refused.value)


def test_the_example_is_what_init_writes() -> None:
    assert (ROOT / "deploy" / "lab.toml").read_bytes() == (ROOT / "swarm/config/lab.toml").read_bytes()
    assert [robot.id for robot in Laboratory.load(ROOT / "deploy" / "lab.toml").robot] == ["r1", "r2"]
