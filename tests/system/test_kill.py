"""Killed, stopped and interrupted in mid-run: a clear end, nobody left behind, and a log that can be read."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from swarm.logs.check import check_log
from swarm.logs.reader import LogReader, Part
from swarm.logs.trial_logs import logs_in
from swarm.messages import topics
from swarm.runtime.lockstep import WAKE_S, WAKES_WITHOUT_HUB
from tests.support.swarm_runs import experiment_text, run_server, write_experiment
from tests.support.watched_server import WatchedServer

LONG = 1_000_000


@pytest.fixture
def server(tmp_path: Path) -> Iterator[WatchedServer]:
    """A run that would go on for days, once it is under way."""
    experiment = write_experiment(tmp_path, experiment_text(moves=LONG))
    with WatchedServer(experiment, tmp_path / "run") as server:
        server.wait_until_under_way()
        assert set(server.children) == {"tracker", "robots-0", "robots-1", "robots-2"}
        yield server


def messages_in(server: WatchedServer) -> LogReader:
    """The log, read to its end."""
    (log,) = logs_in(server.out, [])
    reader = LogReader(log.path)
    for _ in reader.parts():
        pass
    return reader


def is_move(part: Part) -> bool:
    return part.channel.topic is topics.MOVE


def trial_state(server: WatchedServer) -> str:
    manifest = json.loads((server.out / "manifest.json").read_text())
    return str(manifest["trials"][0]["state"])


@pytest.mark.parametrize("victim", ["robots-1", "tracker"])
def test_a_killed_process_is_named_and_the_log_is_closed(server: WatchedServer, victim: str) -> None:
    os.kill(server.children[victim].pid, signal.SIGKILL)
    assert server.finish() == 1
    assert (
        f"failed: process {victim} (pid {server.children[victim].pid}) was killed by SIGKILL" in server.shown
    )
    assert all(child.ended() for child in server.children.values())
    log = messages_in(server)
    assert not log.damage
    assert log.recorded_messages == log.messages > 1000
    assert trial_state(server) == "interrupted"


def test_a_killed_server_leaves_nobody_behind_and_a_log_up_to_there(server: WatchedServer) -> None:
    server.process.kill()
    assert all(child.ended() for child in server.children.values())
    log = messages_in(server)
    assert log.recorded_messages is None, "there is no index"
    assert log.messages > 1000
    assert "the log is cut short" in check_log(log.path).damage[0]
    assert "its server was killed" in check_log(log.path).lacking[0]
    for output in (server.out / "output" / "trial-000").glob("*.log"):
        assert "the server is gone" in output.read_text()


def test_ctrl_c_ends_cleanly(server: WatchedServer) -> None:
    server.process.send_signal(signal.SIGINT)
    assert server.finish() == 130
    assert all(child.ended() for child in server.children.values())
    assert "Traceback" not in server.shown
    log = messages_in(server)
    assert not log.damage
    assert log.recorded_messages == log.messages > 1000
    assert trial_state(server) == "interrupted"
    faults = check_log(log.path).faults
    assert faults == ["the trial was interrupted: the server was ended by SIGINT"]
    told = json.loads((server.out / "run.json").read_text())
    assert told["trials"][0]["messages"] == log.messages
    assert told["moves"] == sum(len(part.sequence) for part in LogReader(log.path).parts() if is_move(part))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, bytes]:
    """An experiment of a few seconds, and its log."""
    directory = tmp_path_factory.mktemp("undisturbed")
    experiment = write_experiment(directory, experiment_text(moves=200))
    run_server(experiment, directory / "run")
    return experiment, (directory / "run" / "trial-000.mcap").read_bytes()


@pytest.fixture
def disturbed(undisturbed: tuple[Path, bytes], tmp_path: Path) -> Iterator[WatchedServer]:
    """The same under way; whatever a test does to it, it must end as if nothing had been."""
    experiment, log = undisturbed
    with WatchedServer(experiment, tmp_path / "run") as server:
        server.wait_until_under_way()
        yield server
        assert server.finish() == 0
    assert (tmp_path / "run" / "trial-000.mcap").read_bytes() == log


def test_a_stopped_process_is_named_and_the_log_shows_nothing_of_it(disturbed: WatchedServer) -> None:
    victim = disturbed.children["robots-2"]
    os.kill(victim.pid, signal.SIGSTOP)
    disturbed.wait_for("still waits for robots-2")
    os.kill(victim.pid, signal.SIGCONT)


def test_a_stopped_server_finds_its_processes_waiting(disturbed: WatchedServer) -> None:
    """Ctrl-Z for longer than a process looks for a server that was killed."""
    disturbed.process.send_signal(signal.SIGSTOP)
    assert not disturbed.children["robots-2"].ended(within_s=3 * WAKE_S * WAKES_WITHOUT_HUB)
    disturbed.process.send_signal(signal.SIGCONT)
