"""Bad calls, as a person makes them: one clear line, exit code 2, nothing overwritten."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from swarm.runtime.liveliness import Presence, claim, present
from swarm.runtime.zenoh_session import Session, SessionSettings
from tests.support.endpoints import free_endpoint
from tests.support.swarm_runs import ROOT, experiment_text, write_experiment


def refused(module: str, *arguments: object) -> str:
    """Run a command that has to be refused; the one line that it printed."""
    command = [sys.executable, "-m", module, *(str(argument) for argument in arguments)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    lines = done.stderr.splitlines()
    assert (done.returncode, done.stdout, len(lines)) == (2, "", 1), done.stderr
    assert lines[0].startswith("error: ")
    return lines[0]


@pytest.fixture
def experiment(tmp_path: Path) -> Path:
    return write_experiment(tmp_path, experiment_text())


def test_a_wrong_experiment_file_starts_nothing(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, experiment_text().replace("moves", "mooves"))
    assert "small.toml:3: unknown key 'mooves'; did you mean 'moves'?" in refused(
        "server", file, "--out", tmp_path / "run"
    )
    assert not (tmp_path / "run").exists()


def test_a_run_directory_that_exists_is_left_alone(tmp_path: Path, experiment: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "trial-000.mcap").write_bytes(b"precious")
    assert f"{run}: exists already; nothing is overwritten" in refused("server", experiment, "--out", run)
    assert [path.name for path in run.iterdir()] == ["trial-000.mcap"]
    assert (run / "trial-000.mcap").read_bytes() == b"precious"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--moves", "0"), "--moves"),
        (("--moves", "abc"), "--moves"),
        (("--seed", "-1"), "--seed"),
        (("--speed", "fast"), "'fast' is no number from 0.01 to 1000, nor max"),
        (("--speed", "0"), "--speed"),
        (("--speeed", "1"), "--speeed"),
        (("--out=-rf",), "--out"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_a_bad_option_is_named(tmp_path: Path, experiment: Path, arguments: Sequence[str], said: str) -> None:
    line = refused("server", experiment, "--out", tmp_path / "run", *arguments)
    assert said in line
    assert "--help" in line
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    "option",
    ["--moves=abc", "--moves=-1", "--moves=100000000000", "--seed=-1", "--speed=0", "--out=-rf"],
)
@pytest.mark.parametrize("command", ["server", "swarm simulate"])
def test_an_error_names_the_option_and_the_help_of_the_command_that_was_called(
    tmp_path: Path, experiment: Path, command: str, option: str
) -> None:
    module, *verb = command.split()
    line = refused(module, *verb, experiment, "--out", tmp_path / "run", option)
    called = "swarm-server" if module == "server" else command
    assert option.split("=")[0] in line
    assert line.endswith(f"(see `{called} --help`)")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("option", ["--moves=100000000000", "--seed=-1", "--trial=-1", "--speed=0"])
@pytest.mark.parametrize("module", ["robot_agent", "tracker_bridge"])
def test_the_other_processes_know_the_same_limits(experiment: Path, module: str, option: str) -> None:
    assert option.split("=")[0] in refused(module, experiment, option)


def test_a_busy_port_is_named(tmp_path: Path, experiment: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        endpoint = f"tcp/127.0.0.1:{other.getsockname()[1]}"
        line = refused("server", experiment, "--out", tmp_path / "run", "--listen", endpoint)
    assert f"cannot listen on {endpoint}" in line
    assert not (tmp_path / "run").exists()


def test_an_unknown_robot_is_named(experiment: Path) -> None:
    line = refused("robot_agent", experiment, "--robot", "imitater")
    assert "'imitater' is not in the experiment; did you mean 'imitator'?" in line
    assert "known: expert, imitator, loner" in refused("robot_agent", experiment)


def test_an_unknown_tracker_is_named(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, experiment_text(extra='[tracker]\nbackend = "vicom"'))
    assert "'vicom'" in refused("tracker_bridge", file)


def test_a_lockstep_waits_for_no_real_tracker(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, experiment_text(extra='[tracker]\nbackend = "vicon"'))
    line = refused("server", file, "--out", tmp_path / "run")
    assert "'vicon', which has a time of its own: a simulation needs \"sim\"" in line
    assert not (tmp_path / "run").exists()


def test_a_second_agent_of_one_id_is_refused_and_both_hosts_are_named(experiment: Path) -> None:
    endpoint = free_endpoint()
    with Session(SessionSettings(endpoint, hub=True)) as hub, Session(SessionSettings(endpoint)) as first:
        claim(first, Presence("robot", "loner", "other-board", 1))
        while not present(hub, "robot"):
            pass
        line = refused("robot_agent", experiment, "--robot", "loner", "--connect", endpoint)
    assert "robot 'loner' is already alive on host 'other-board'" in line
    assert repr(socket.gethostname()) in line


@pytest.mark.parametrize("command", ["swarm simulate", "swarm trials", "robot_agent --robot=loner"])
def test_every_command_looks_at_the_whole_experiment_before_it_starts(tmp_path: Path, command: str) -> None:
    file = write_experiment(tmp_path, experiment_text(extra='[camera]\nconditions = "sunny"'))
    module, *words = command.split()
    out = ["--out", tmp_path / "run"] if module == "swarm" else []
    assert "unknown camera conditions 'sunny'" in refused(module, *words, file, *out)
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]


def test_state_that_cannot_be_written_is_found_before_the_run(experiment: Path) -> None:
    line = refused("robot_agent", experiment, "--robot", "loner", "--state", "/proc/state")
    assert "--state: " in line


def test_a_laboratory_has_no_speed(tmp_path: Path, experiment: Path) -> None:
    options = ("--listen", "tcp/127.0.0.1:0", "--speed", "3", "--out", tmp_path / "run")
    assert "--speed is for simulations" in refused("server", experiment, *options)
    assert not (tmp_path / "run").exists()
