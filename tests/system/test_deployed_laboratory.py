"""Three boards and a server, from nothing to a run that is over, with the commands that the README tells.

Boards are network namespaces with OpenSSH and no way to any other network. Their robots are emulated e-pucks
over Wi-Fi, behind the real driver.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from tests.support.board_network import OPERATOR, NetworkBoard, board_network, can_have_boards
from tests.support.laboratory import SMALL_AND_QUICK
from tests.support.swarm_runs import ROOT
from tests.support.waiting import until

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not can_have_boards(), reason="needs root, ip and sshd"),
]

MOVES = 100
"""Of each robot: 300 together, in two minutes of a machine that keeps pace with them."""
ROBOTS = {f"r{number}": f"{OPERATOR}:{1000 + number}" for number in (1, 2, 3)}
"""Each with the address at which its board reaches it."""


class DeployedLaboratory:
    """A laboratory file for boards, an experiment, and the commands."""

    def __init__(self, directory: Path, boards: list[NetworkBoard], stack: ExitStack) -> None:
        self.directory = directory
        self.server, *self.robots = boards
        self._stack = stack
        self.write()

    def write(self, moves: int = MOVES, of_r3: str = "") -> None:
        """Both files; r3's table may say more."""
        experiment = f'[run]\nname = "first"\nmoves = {moves}\n[arena]\n{SMALL_AND_QUICK}'
        laboratory = '[laboratory]\nname = "arena"\n[policies]\nservices = "supervised"\n'
        laboratory += f'known_hosts = "known_hosts"\n[server]\n{_machine(self.server)}'
        for number, (robot, board) in enumerate(zip(ROBOTS, self.robots, strict=True)):
            table = f'[[robot]]\nid = "{robot}"\ndriver = "wifi"\naddress = "{ROBOTS[robot]}"\n'
            table += f"south_west_m = [{0.2 + 0.5 * number}, 0.2]\n"
            experiment += table
            laboratory += table + _machine(board) + (of_r3 if robot == "r3" else "")
        (self.directory / "experiment.toml").write_text(experiment)
        (self.directory / "lab.toml").write_text(laboratory)

    def swarm(self, *words: str) -> dict[str, Any]:
        """What a command prints with --json; its messages are shown if the test fails."""
        command = [sys.executable, "-m", "swarm", *words, "--json"]
        environment = {**os.environ, "HOME": str(self.directory)}
        done = subprocess.run(
            command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True, check=False
        )
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return found

    def deploy(self, *words: str) -> list[dict[str, Any]]:
        """The machines in what `swarm deploy` prints."""
        files = (str(self.directory / "lab.toml"), str(self.directory / "experiment.toml"))
        machines: list[dict[str, Any]] = self.swarm("deploy", *files, *words)["machines"]
        return machines

    def emulate(self) -> None:
        """All robots, on the operator's machine: who plays bodies does so with the tracker's credentials."""
        words = [sys.executable, "-m", "robot_agent", "emulate-robots"]
        words += [f"--address={robot}={address}" for robot, address in ROBOTS.items()]
        words += ["--connect", f"tls/{self.server.host}:7447"]
        words += ["--credentials", str(self.directory / "keys" / "tracker")]
        words += [str(self.directory / "experiment.toml")]
        process = self._stack.enter_context(subprocess.Popen(words, cwd=ROOT))
        self._stack.callback(process.kill)

    def state(self, board: NetworkBoard, service: str) -> str:
        """Of a service on a board."""
        file = board.folder / "swarm" / "services" / f"{service}.json"
        return str(json.loads(file.read_text())["state"])

    def stop(self) -> None:
        """End every supervisor."""
        for lock in self.directory.glob("machine-*/swarm/services/*.lock"):
            pid = int(lock.read_text())
            if "supervisor" in _command_of(pid):
                os.kill(pid, signal.SIGTERM)
                until(lambda pid=pid: not _command_of(pid))  # type: ignore[misc]


def _machine(board: NetworkBoard) -> str:
    directory = board.folder / "swarm"
    return f'host = "{board.host}"\nuser = "root"\npython = "{BASE_PYTHON}"\ndirectory = "{directory}"\n'


BASE_PYTHON = Path(sys.base_prefix) / "bin" / "python3"
"""Without any package of this test's environment."""


def _command_of(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return ""


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[DeployedLaboratory]:
    with board_network(tmp_path, 4) as boards, ExitStack() as stack:
        found = DeployedLaboratory(tmp_path, boards, stack)
        stack.callback(found.stop)
        yield found


def test_from_nothing_to_a_run_that_is_over(laboratory: DeployedLaboratory) -> None:
    files = [str(laboratory.directory / name) for name in ("lab.toml", "experiment.toml")]
    laboratory.swarm("lab", "keys", files[0], "--simulated")
    assert all(found["level"] == "good" for found in laboratory.swarm("lab", "check", *files)["findings"])

    first = laboratory.deploy()
    assert [machine["state"] for machine in first] == ["deployed"] * 4, first
    assert len(first[0]["copied"]) > len(first[1]["copied"]), "a board needs less than the server"

    (laboratory.directory / "no-camera.toml").write_text("what = 1\n")
    laboratory.write(MOVES + 1, of_r3='calibration = "no-camera.toml"\n')
    second = laboratory.deploy()
    assert [machine["state"] for machine in second] == ["deployed"] * 3 + ["failed"], second
    assert second[3]["reason"].endswith("the release before runs again")
    assert laboratory.state(laboratory.robots[2], "swarm-agent@r3") == "active"

    laboratory.write(MOVES)
    third = laboratory.deploy("--run")
    assert [machine["state"] for machine in third] == ["deployed"] * 3 + ["unchanged"], third
    assert [machine["copied"] for machine in third] == [[]] * 4
    assert laboratory.deploy("--run")[0]["state"] == "unchanged"
    laboratory.emulate()
    reached = laboratory.swarm("lab", "check", *files, "--reach")["findings"]
    assert not [found for found in reached if found["level"] == "bad"]

    until(lambda: laboratory.state(laboratory.server, "swarm-server") == "stopped")
    runs = sorted((laboratory.server.folder / "swarm" / "runs").iterdir())
    checked = laboratory.swarm("check", str(runs[-1]))
    assert checked["sound"], checked
    summary = json.loads((runs[-1] / "run.json").read_text())
    assert summary["moves"] >= len(ROBOTS) * MOVES
