"""`swarm trials` and `swarm durations`: many trials from the command line."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from swarm.config.experiment import Experiment
from swarm.surrogate.copies import STORED_COPIES
from swarm.surrogate.durations import MEASURED_DURATIONS
from swarm.surrogate.trials import run_trials, summary
from tests.conftest import SmallRun
from tests.support.swarm_runs import ROOT

EXPERT = ROOT / "deploy" / "sim" / "expert.toml"


def swarm(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from swarm.cli.main import main; main()", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    out = tmp_path_factory.mktemp("trials") / "out"
    done = swarm(
        "trials", str(EXPERT), "--trials", "6", "--moves", "1200", "--out", str(out), "--jobs", "1", "--json"
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def test_imitating_an_expert_pays(result: dict[str, Any]) -> None:
    """Figure 25's effect at move 1,000, in six trials."""
    at = {name: result["conditions"][name]["mean_and_interval"]["1000"] for name in CONDITIONS}
    assert at["imitation"][0] < 40 < 75 < at["no-imitation"][0]
    assert 30 < result["conditions"]["copies"]["remembered"] <= 60, "ten of each trial, if it gets that far"


def test_paths_that_arrive_by_luck_are_told_apart(result: dict[str, Any]) -> None:
    alone = result["conditions"]["no-imitation"]
    assert alone["mean_learnt"]["1000"][0] >= alone["mean_and_interval"]["1000"][0]


CONDITIONS = ("imitation", "no-imitation")


def test_tables_hold_every_trial_and_their_mean(result: dict[str, Any]) -> None:
    with Path(result["files"]["curves"]).open(newline="") as file:
        means = {(row["condition"], row["move"]): row for row in csv.DictReader(file)}
    with Path(result["files"]["trials"]).open(newline="") as file:
        trials = {(row["condition"], row["move"]): row for row in csv.DictReader(file)}
    assert means.keys() == trials.keys()
    assert len(means) == 2 * 120
    for place, row in means.items():
        values = [float(trials[place][f"trial_{number}"]) for number in range(6)]
        assert float(row["mean"]) == pytest.approx(np.mean(values), abs=1e-3)
        assert float(row["low"]) <= float(row["mean"]) <= float(row["high"])


def test_the_picture_is_there(result: dict[str, Any]) -> None:
    assert Path(result["files"]["picture"]).read_bytes().startswith(b"\x89PNG")


def test_an_existing_directory_is_not_touched(tmp_path: Path) -> None:
    done = swarm("trials", str(EXPERT), "--trials", "1", "--moves", "10", "--out", str(tmp_path))
    assert done.returncode == 2
    assert "nothing is overwritten, choose another --out" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_too_few_moves_are_refused(tmp_path: Path) -> None:
    done = swarm("trials", str(EXPERT), "--trials", "1", "--moves", "9", "--out", str(tmp_path / "new"))
    assert done.returncode == 2
    assert "9 moves give no curve" in done.stderr


def test_the_number_of_jobs_changes_nothing() -> None:
    experiment = Experiment.load(EXPERT).changed(moves=200)
    alone = run_trials(experiment, STORED_COPIES, MEASURED_DURATIONS, 3, jobs=1)
    shared = run_trials(experiment, STORED_COPIES, MEASURED_DURATIONS, 3, jobs=2)
    assert alone.outcomes == shared.outcomes
    assert summary(alone) == summary(shared)


def test_durations_of_a_log_are_written(small_run: SmallRun, tmp_path: Path) -> None:
    out = tmp_path / "durations.csv"
    done = swarm("durations", str(small_run.directory), "--out", str(out), "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["measured"]["turn0-diagonal"] > 10
    assert out.read_text().splitlines()[1] == "kind,duration_s"
