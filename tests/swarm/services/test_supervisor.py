"""A service under the supervisor, from the units that ship: ready, watched, started again, stopped."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from swarm.services.notification import ServiceManager
from swarm.services.unit import Unit
from tests.support.swarm_runs import ROOT
from tests.support.waiting import until

READY = """import os, time
from swarm.services.notification import ServiceManager
manager = ServiceManager.of_environment()
manager.about("warming up")
manager.ready()
"""
LIVES = READY + "while True:\n    manager.going_on()\n    time.sleep(0.05)\n"
HANGS = READY + "time.sleep(1000)\n"
NEVER_READY = "import time\ntime.sleep(1000)\n"
FAILS = "import sys\nsys.exit(3)\n"
ENDS = READY


@contextmanager
def service(directory: Path, program: str, settings: str) -> Iterator[Callable[[], dict[str, Any]]]:
    """A supervised program; what is known of it."""
    (directory / "program.py").write_text(program)
    unit = directory / "unit.service"
    unit.write_text(
        f"[Service]\nWorkingDirectory={ROOT}\nExecStart={sys.executable} {directory}/program.py\n"
        f"RestartSec=100ms\nRestartMaxDelaySec=200ms\n{settings}"
    )
    state = directory / "state.json"
    words = [sys.executable, "-m", "swarm.services.supervisor", str(unit), "", str(state)]

    def known() -> dict[str, Any]:
        found: dict[str, Any] = json.loads(state.read_text()) if state.exists() else {"state": ""}
        return found

    with subprocess.Popen(words, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}) as supervisor:
        try:
            yield known
        finally:
            supervisor.terminate()
            supervisor.wait()


def test_a_process_that_says_so_is_ready_and_goes_on(tmp_path: Path) -> None:
    with service(tmp_path, LIVES, "WatchdogSec=5s\n") as known:
        until(lambda: known()["state"] == "active")
        pid = known()["pid"]
    assert known()["state"] == "stopped"
    assert not Path(f"/proc/{pid}").exists()


@pytest.mark.parametrize(
    ("program", "settings"),
    [
        (HANGS, "WatchdogSec=300ms\nRestart=on-failure\n"),
        (NEVER_READY, "TimeoutStartSec=300ms\nRestart=on-failure\n"),
        (FAILS, "Restart=on-failure\n"),
        (ENDS, "Restart=always\n"),
    ],
    ids=["hangs", "never ready", "fails", "ends"],
)
def test_it_is_started_again(tmp_path: Path, program: str, settings: str) -> None:
    with service(tmp_path, program, settings) as known:
        until(lambda: known().get("restarts", 0) >= 2)


def test_a_killed_process_is_started_again(tmp_path: Path) -> None:
    with service(tmp_path, LIVES, "Restart=always\n") as known:
        until(lambda: known()["state"] == "active")
        first = known()["pid"]
        os.kill(first, signal.SIGKILL)
        until(lambda: known()["state"] == "active" and known()["pid"] != first)
        assert known()["restarts"] == 1


@pytest.mark.parametrize(("program", "state"), [(FAILS, "failed"), (ENDS, "stopped")], ids=["fails", "ends"])
def test_without_restart_it_stays_as_it_ended(tmp_path: Path, program: str, state: str) -> None:
    with service(tmp_path, program, "Restart=no\n") as known:
        until(lambda: known()["state"] == state)


def test_the_watchdog_of_another_process_is_none_of_ours() -> None:
    environment = {"WATCHDOG_PID": "1", "WATCHDOG_USEC": "1000", "NOTIFY_SOCKET": "/nowhere"}
    ServiceManager.of_environment(environment).going_on()  # a manager that is gone ends nobody


def test_a_unit_is_read_as_systemd_reads_it(tmp_path: Path) -> None:
    (tmp_path / "agent-r1.env").write_text("SWARM_ENDPOINT=tcp/10.0.0.9:7447\nSWARM_OPTIONS=--trial 2\n")
    text = (ROOT / "deploy" / "systemd" / "swarm-agent@.service").read_text()
    (tmp_path / "unit").write_text(text.replace("/home/swarm/swarm/current", str(tmp_path)))
    unit = Unit.read(tmp_path / "unit", "r1")
    assert unit.command[0] == f"{tmp_path}/program/bin/robot-agent"
    options = "experiment.toml --robot r1 --connect tcp/10.0.0.9:7447"
    assert " ".join(unit.command[1:7]).startswith(options)
    assert unit.command[-2:] == ("--trial", "2")
    assert (unit.watchdog_s, unit.restart, unit.restart_after_s, unit.restart_after_at_most_s) == (
        30,
        "always",
        1,
        60,
    )
