"""Trials side by side: the logs of trials one after the other, changed values in them, and nothing left."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from pathlib import Path

import pytest

from swarm.config.experiment import Experiment
from swarm.logs.reader import LogReader
from swarm.logs.trial_logs import open_path
from swarm.replay.recorded import read_recording
from tests.support.swarm_runs import ROOT, experiment_text, run_server, server_command, write_experiment
from tests.system.test_signals import left_behind

CHANGE = "--set=learning.epsilon=0.5"


def test_logs_are_the_same_and_say_what_was_changed(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, experiment_text(moves=3))
    one, other = tmp_path / "one", tmp_path / "other"
    serial = run_server(file, one, CHANGE, "--trials", "2")
    together = run_server(file, other, CHANGE, "--trials", "2", "--jobs", "2")
    assert serial["digest"] == together["digest"]
    assert [log.read_bytes() for log in sorted(one.glob("*.mcap"))] == [
        log.read_bytes() for log in sorted(other.glob("*.mcap"))
    ]
    recording = read_recording([other / "trial-001.mcap"])
    assert recording.experiment({}) == Experiment.load(file, ["learning.epsilon=0.5", "run.trials=2"])
    manifest = json.loads((other / "manifest.json").read_text())
    assert manifest["set"] == ["learning.epsilon=0.5", "run.trials=2"]
    assert {record["state"] for record in manifest["trials"]} == {"complete"}


@pytest.mark.parametrize("told", [signal.SIGTERM, signal.SIGKILL], ids=lambda told: told.name)
def test_trials_end_with_their_server(tmp_path: Path, told: signal.Signals) -> None:
    file, run = write_experiment(tmp_path, experiment_text(moves=1_000_000)), tmp_path / "run"
    command = server_command(file, run, "--trials", "3", "--jobs", "2")
    server = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)
    logs = [run / "trial-000.mcap", run / "trial-001.mcap"]
    written = [open_path(log) for log in logs]
    while server.poll() is None and not all(log.exists() and log.stat().st_size > 8192 for log in written):
        os.sched_yield()
    server.send_signal(told)
    _, said = server.communicate()
    assert server.returncode == (-told if told is signal.SIGKILL else 128 + told)
    assert "Traceback" not in said
    while left_behind(str(run)):
        os.sched_yield()
    endings = []
    for log in logs:
        reader = LogReader(log)
        endings.append(reader.read_metadata()["end"]["state"])
    assert endings == ["interrupted", "interrupted"]
