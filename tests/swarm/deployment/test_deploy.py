"""Three boards, from nothing to services that run: what is deployed, what stays as it is, what goes back."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from swarm.cli.app import app
from swarm.errors import UserError
from tests.support.boards import Boards, new_key, small_program, small_wheelhouse
from tests.support.waiting import until

EXPERIMENT = """[run]
name = "first"
moves = 300

[[robot]]
id = "r2"
south_west_m = [0.15, 0.3]

[[robot]]
id = "r3"
south_west_m = [1.65, 0.3]
"""


class Laboratory:
    """A laboratory file for boards, and `swarm deploy` of it."""

    def __init__(self, boards: Boards) -> None:
        self.boards = boards
        self.directory = boards.directory
        self.wheelhouse = small_wheelhouse(self.directory / "wheelhouse")
        self.experiment = self.directory / "experiment.toml"
        self.experiment.write_text(EXPERIMENT)
        self.write("1.0")

    def write(self, version: str, of_r2: str = "", of_r3: str = "") -> None:
        """The file, with a version, and with more lines in a robot's table, or others."""
        server, *robots = [self._machine(number, more) for number, more in enumerate(("", of_r2, of_r3))]
        text = f"""[laboratory]
name = "arena"
[versions]
program = "{version}"
[policies]
services = "supervised"
[server]
{server}"""
        for number, machine in enumerate(robots):
            text += f"""[[robot]]
id = "r{number + 2}"
driver = "sim"
south_west_m = [{0.15 + 1.5 * number}, 0.3]
{machine}"""
        (self.directory / "lab.toml").write_text(text)

    def _machine(self, number: int, more: str) -> str:
        values = {
            "host": self.boards.hosts[number],
            "ssh_port": self.boards.ports[number],
            "python": sys.executable,
            "directory": str(self.boards.folder(number)),
        }
        given = more.partition(" =")[0]
        lines = (f"{name} = {json.dumps(value)}\n" for name, value in values.items() if name != given)
        return "".join(lines) + more

    def deploy(self, *words: str) -> list[dict[str, Any]]:
        """The machines in what `--json` prints."""
        done = CliRunner().invoke(
            app, ["deploy", str(self.directory / "lab.toml"), *words, "--insecure", "--json"]
        )
        if not done.stdout:
            assert done.exception
            raise done.exception
        machines: list[dict[str, Any]] = json.loads(done.stdout.splitlines()[-1])["machines"]
        assert (done.exit_code == 0) == all(machine["state"] != "failed" for machine in machines)
        return machines

    def bad_on_reach(self) -> list[dict[str, Any]]:
        """What `swarm lab check --reach` finds bad."""
        call = ["lab", "check", str(self.directory / "lab.toml"), "--reach", "--json"]
        done = CliRunner().invoke(app, call)
        found = json.loads(done.stdout)["findings"]
        bad = [finding for finding in found if finding["level"] == "bad"]
        assert done.exit_code == bool(bad)
        return bad

    def running(self) -> list[int]:
        """The process ids of all services."""
        states = self.directory.glob("board-*/services/*.json")
        return [json.loads(state.read_text())["pid"] for state in sorted(states)]

    def releases(self) -> list[str]:
        """What runs on each board."""
        return [(self.boards.folder(number) / "current").resolve().name for number in range(3)]

    def stop(self) -> None:
        """End every supervisor, and wait for its end."""
        for lock in self.directory.glob("board-*/services/*.lock"):
            pid = int(lock.read_text())
            os.kill(pid, 15)
            until(lambda pid=pid: not _alive(pid))  # type: ignore[misc]


def _alive(pid: int) -> bool:
    """Whether a process runs; one that only waits to be reaped does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where ssh looks for keys."""
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path / "home"


@pytest.fixture
def laboratory(tmp_path: Path, home: Path) -> Iterator[Laboratory]:
    with Boards(tmp_path, [new_key() for _ in range(3)]).served(home) as boards:
        found = Laboratory(boards)
        yield found
        found.stop()


def states(machines: list[dict[str, Any]]) -> list[str]:
    return [machine["state"] for machine in machines]


def first_deployment(laboratory: Laboratory) -> list[dict[str, Any]]:
    """Version 1.0 on every board, and a run that has begun."""
    small_program(laboratory.wheelhouse, "1.0")
    machines = laboratory.deploy(str(laboratory.experiment), "--run")
    assert states(machines) == ["deployed"] * 3, [machine["reason"] for machine in machines]
    return machines


def test_from_nothing_to_services_that_run(laboratory: Laboratory) -> None:
    first = first_deployment(laboratory)
    assert [machine["services"] for machine in first] == [
        {"swarm-server.service": "active", "swarm-bridge.service": "active"},
        {"swarm-agent@r2.service": "active"},
        {"swarm-agent@r3.service": "active"},
    ]
    running, again = laboratory.running(), laboratory.deploy(str(laboratory.experiment), "--run")
    assert states(again) == states(laboratory.deploy()) == ["unchanged"] * 3
    assert laboratory.running() == running, "nobody was started anew"

    laboratory.write("1.0", of_r3='address = "elsewhere"\n')
    for change in ((), ("--rollback",)):
        with pytest.raises(UserError, match=r"a run is under way \(tracker, server on 127\.0\.0\.1\)"):
            laboratory.deploy(*change)
    assert laboratory.running() == running, "a run that is under way is not ended without being asked to"

    commands = laboratory.boards.commands
    assert {command.split(" ", 1)[0] for command in commands} == {sys.executable}
    assert all(re.fullmatch(r"[\w./-]+ [\w./-]+\.pyz", command) for command in commands), "no name of ours"
    assert not _secrets_in_the_open(laboratory.directory)


@pytest.mark.faults
def test_a_version_that_does_not_start_on_one_board(laboratory: Laboratory) -> None:
    first = first_deployment(laboratory)
    small_program(laboratory.wheelhouse, "2.0")
    laboratory.write("2.0", of_r3='address = "broken"\n')
    second = laboratory.deploy("--interrupt")
    assert states(second) == ["deployed", "deployed", "failed"]
    assert "swarm-agent@r3.service is restarting (error: this robot is broken)" in second[2]["reason"]
    assert second[2]["reason"].endswith("; the release before runs again")
    assert laboratory.releases() == [second[0]["release"], second[1]["release"], first[2]["release"]]

    (unlike,) = laboratory.bad_on_reach()
    assert unlike["about"] == "r3 on 127.0.0.3"
    assert "program 1.0" in unlike["found"]
    assert "the others have program 2.0" in unlike["found"]

    laboratory.write("2.0", of_r2='calibration = "camera.toml"\n')
    (laboratory.directory / "camera.toml").write_text("")
    third = laboratory.deploy("--interrupt")
    assert states(third) == ["unchanged", "deployed", "deployed"]
    assert [machine["copied"] for machine in third] == [[], [], []], "the wheels were there"
    assert third[1]["changes"] == ["agent-r2.env", "camera-r2.toml"]
    assert third[2]["changes"] == ["program"]
    assert not laboratory.bad_on_reach()

    back = laboratory.deploy("--rollback", "--interrupt")
    assert states(back) == ["rolled back"] * 3
    assert laboratory.releases() == [first[0]["release"], second[1]["release"], first[2]["release"]]


def _secrets_in_the_open(directory: Path) -> list[Path]:
    """Files of releases that others on the machine could read."""
    files = (path for path in directory.glob("board-*/releases/*/*.env"))
    return [path for path in files if path.stat().st_mode & 0o077]


def test_a_board_with_another_host_key_is_not_spoken_to(laboratory: Laboratory) -> None:
    small_program(laboratory.wheelhouse, "1.0")
    known = laboratory.directory / "home" / ".ssh" / "known_hosts"
    lines = known.read_text().splitlines()
    stranger = new_key().export_public_key().decode()
    known.write_text("\n".join([*lines[:2], f"{lines[2].split()[0]} {stranger}"]))
    outcomes = laboratory.deploy("--dry-run")
    assert states(outcomes) == ["would change", "would change", "failed"]
    assert "its host key is not among the known ones" in outcomes[2]["reason"]
    assert not laboratory.boards.folder(2).exists()


def test_a_card_that_was_copied_is_refused_and_both_are_named(tmp_path: Path, home: Path) -> None:
    of_server, of_card = new_key(), new_key()
    same = r"r2 on 127\.0\.0\.2 and r3 on 127\.0\.0\.3 have the same host key"
    with Boards(tmp_path, [of_server, of_card, of_card]).served(home) as boards:
        laboratory = Laboratory(boards)
        with pytest.raises(UserError, match=same):
            laboratory.deploy("--dry-run")


def test_machines_that_cannot_be_used_are_told_with_the_reason(laboratory: Laboratory) -> None:
    small_program(laboratory.wheelhouse, "1.0")
    laboratory.write("1.0", of_r2='python = "/nowhere/python3"\n', of_r3="ssh_port = 1\n")
    outcomes = laboratory.deploy("--dry-run")
    assert states(outcomes) == ["would change", "failed", "failed"]
    assert "/nowhere/python3" in outcomes[1]["reason"]
    assert outcomes[2]["reason"].startswith("it cannot be reached (")


def test_a_dry_run_changes_nothing(laboratory: Laboratory) -> None:
    small_program(laboratory.wheelhouse, "1.0")
    assert states(laboratory.deploy("--dry-run")) == ["would change"] * 3
    assert not list(laboratory.directory.glob("board-*/current"))


def test_nobody_goes_back_to_nothing(laboratory: Laboratory) -> None:
    outcomes = laboratory.deploy("--rollback")
    assert states(outcomes) == ["failed"] * 3
    assert {outcome["reason"] for outcome in outcomes} == {"there is no release to go back to"}
