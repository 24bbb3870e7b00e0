"""What the processes tell whoever started them as services: that they are ready, and that they go on."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.endpoints import free_endpoint
from tests.support.laboratory import quick_text
from tests.support.swarm_runs import ROOT, write_experiment

PROCESSES = {
    "robot_agent": ("--robot", "r0", "--connect"),
    "tracker_bridge": ("--connect",),
    "server": ("--listen",),
}


@contextmanager
def told(directory: Path, process: str) -> Iterator[Iterator[str]]:
    """What a process that waits for others tells its manager, line by line."""
    file = write_experiment(directory, quick_text())
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(directory / "notify"))
        environment = {"NOTIFY_SOCKET": str(directory / "notify"), "WATCHDOG_USEC": "500000"}
        words = [sys.executable, "-m", process, str(file), *PROCESSES[process], free_endpoint()]
        words += ["--out", str(directory / "run")] if process == "server" else []
        with subprocess.Popen(
            words, cwd=ROOT, env={**os.environ, **environment}, stderr=subprocess.DEVNULL
        ) as running:
            try:
                yield iter(lambda: manager.recv(4096).decode(), "")
            finally:
                running.terminate()


@pytest.mark.parametrize("process", PROCESSES)
def test_a_process_that_waits_is_ready_and_goes_on(tmp_path: Path, process: str) -> None:
    with told(tmp_path, process) as lines:
        assert next(lines) == "READY=1"
        seen = [next(lines) for _ in range(4)]
    assert seen.count("WATCHDOG=1") >= 3, seen
    assert all(line == "WATCHDOG=1" or line.startswith("STATUS=waiting for the server") for line in seen)


def test_a_process_that_cannot_start_is_never_ready(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        words = [sys.executable, "-m", "robot_agent", "nowhere.toml", "--robot", "r0"]
        environment = {**os.environ, "NOTIFY_SOCKET": str(tmp_path / "notify")}
        subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, check=False)
        manager.setblocking(False)
        with pytest.raises(BlockingIOError):
            manager.recv(4096)
