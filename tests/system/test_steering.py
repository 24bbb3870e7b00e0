"""A laboratory's run from its file: started, seen and steered by commands, with everybody's own keys."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from swarm.access.identities import OPERATOR, VIEWER
from swarm.control.reaching import keys_of, settings_of
from swarm.errors import UserError
from swarm.messages import swarm_pb2 as pb
from swarm.runtime.operating import ask_status, send_order
from swarm.runtime.zenoh_session import Session
from tests.support.endpoints import free_endpoint
from tests.support.laboratory import quick_text
from tests.support.operator import Operator, moves
from tests.support.swarm_runs import ROOT, write_experiment


def command(module: str, *words: object) -> list[str]:
    return [sys.executable, "-m", module, *map(str, words)]


def swarm(*words: object) -> dict[str, Any]:
    """What a verb of `swarm` prints with --json."""
    done = subprocess.run(command("swarm", *words, "--json"), cwd=ROOT, capture_output=True, text=True)
    assert done.stdout, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


@pytest.fixture
def laboratory(tmp_path: Path) -> Path:
    """A laboratory file with one robot, all on this machine, and everybody's keys beside it."""
    port = free_endpoint().rpartition(":")[2]
    lines = ["[laboratory]", 'name = "here"', "[server]", 'host = "127.0.0.1"', f"port = {port}"]
    lines += ["[[robot]]", 'id = "r0"', 'host = "127.0.0.1"', 'driver = "sim"', "south_west_m = [0.0, 0.0]"]
    file = tmp_path / "lab.toml"
    file.write_text("\n".join(lines) + "\n")
    swarm("lab", "keys", file, "--simulated")
    return file


def test_a_run_is_started_seen_steered_and_ended_by_commands(laboratory: Path, tmp_path: Path) -> None:
    experiment, run = write_experiment(tmp_path, quick_text()), tmp_path / "run"
    with ExitStack() as stack:
        words = ("run", experiment, "--lab", laboratory, "--out", run, "--json")
        server = stack.enter_context(
            subprocess.Popen(command("swarm", *words), cwd=ROOT, stdout=subprocess.PIPE, text=True)
        )
        stack.callback(server.terminate)
        endpoint = f"tls/{settings_of(str(laboratory)).endpoint.partition('/')[2]}"
        keys = ("--credentials", laboratory.parent / "keys" / "robot-r0")
        agent = stack.enter_context(
            subprocess.Popen(
                command("robot_agent", experiment, "--connect", endpoint, "--robot", "r0", *keys),
                cwd=ROOT,
                stderr=subprocess.DEVNULL,
            )
        )
        stack.callback(agent.kill)
        operator = Operator(waiting_session(laboratory, stack))
        operator.waits_until(lambda status: moves(status) > 3)
        seen = swarm("status", "--at", laboratory)
        assert [robot["robot"] for robot in seen["robots"]] == ["r0"]
        assert (seen["phase"], seen["missing"]) == ("RUNNING", [])
        assert_a_viewer_only_sees(laboratory)
        again = subprocess.run(
            command("swarm", "run", experiment, "--lab", laboratory), cwd=ROOT, capture_output=True, text=True
        )
        assert again.stdout.startswith("a server conducts this run already")
        assert swarm("pause", "--at", laboratory, "--reason", "lunch")["accepted"]
        assert not swarm("pause", "--at", laboratory)["accepted"]
        seen = swarm("status", "--at", run, "--credentials", keys_of(laboratory, OPERATOR))
        assert "(lunch)" in seen["reason"]
        assert swarm("stop", "--at", laboratory)["accepted"]
        printed, _ = server.communicate()
    assert server.returncode == 0
    assert json.loads(printed)["run"] == str(run)
    assert not (run / "endpoint").exists()


def waiting_session(laboratory: Path, stack: ExitStack) -> Session:
    """An operator's session, as soon as the server listens."""
    while True:
        try:
            return stack.enter_context(Session(settings_of(str(laboratory))))
        except UserError:
            continue


def assert_a_viewer_only_sees(laboratory: Path) -> None:
    """What it orders never reaches the server."""
    with Session(settings_of(str(laboratory), credentials=keys_of(laboratory, VIEWER))) as session:
        assert ask_status(session).phase == pb.RunState.RUNNING
        with pytest.raises(UserError, match="no server"):
            send_order(session, pb.OperatorOrder(kind=pb.OperatorOrder.STOP, operator="viewer"))
        assert ask_status(session).phase == pb.RunState.RUNNING


def test_a_place_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is no endpoint"):
        settings_of("nowhere")
    with pytest.raises(UserError, match="nobody listens there"):
        settings_of(str(tmp_path))
