"""A simulation that was interrupted: its finished trials are kept, the rest comes to the same."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.support.swarm_runs import ROOT, experiment_text, run_server, write_experiment
from tests.support.watched_server import WatchedServer


def resumed(run: Path) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "swarm", "simulate", "--resume", str(run), "--json"]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


def test_a_killed_simulation_is_resumed_to_the_same_logs(tmp_path: Path) -> None:
    text = experiment_text(moves=20).replace("[arena]", "trials = 2\n[arena]", 1)
    experiment = write_experiment(tmp_path, text)
    undisturbed = run_server(experiment, tmp_path / "undisturbed")
    run = tmp_path / "run"
    with WatchedServer(experiment, run) as server:
        server.wait_for("trial-001 of 2")
        server.process.kill()
    kept = (run / "trial-000.mcap").stat()
    assert [trial["state"] for trial in json.loads((run / "manifest.json").read_text())["trials"]] == [
        *["complete"] * 3,
        *["running"] * 3,
    ]
    done = resumed(run)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert (result["digest"], result["moves"]) == (undisturbed["digest"], undisturbed["moves"])
    assert (run / "trial-000.mcap").stat().st_mtime_ns == kept.st_mtime_ns, "it was not simulated again"
    assert not list(run.glob("*.part"))
    again = resumed(run)
    assert again.returncode == 2
    assert "all trials of the run are complete; there is nothing to resume" in again.stderr
