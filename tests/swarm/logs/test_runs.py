"""A list of runs: what became of each, by what its server left, and whether a server still holds it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from server.run_directory import RunDirectory
from swarm.cli.app import app
from swarm.errors import UserError
from swarm.logs.runs import runs_in
from tests.support.small_logs import learning_log


def run_directory(parent: Path, name: str, states: list[str], **more: Any) -> Path:
    """A run as its server leaves it: a learner of each condition in each trial."""
    place = RunDirectory.create(parent / name, name).path
    records = [
        {"condition": condition, "robot": robot, "role": role, "trial": trial, "seed": 7, "state": state}
        for trial, state in enumerate(states)
        for robot, role, condition in (
            ("expert", "expert", "expert"),
            ("imitator", "learner", "imitation"),
            ("loner", "learner", "no-imitation"),
        )
    ]
    manifest = {"name": name, "moves": 100, "trials": records, **more}
    (place / "manifest.json").write_text(json.dumps(manifest))
    return place


def test_a_line_tells_what_became_of_a_run(tmp_path: Path) -> None:
    done = run_directory(tmp_path, "done", ["complete", "complete"], set=["learning.epsilon=0.3"])
    best = [{"best_paths": {"imitator": 9, "loner": 100}}, {"best_paths": {"imitator": 12}}]
    (done / "run.json").write_text(json.dumps({"trials": best}))
    learning_log(done / "trial-000.mcap", {"imitator": [20, 9]})
    run_directory(tmp_path, "broken-off", ["complete", "interrupted"])
    (tmp_path / "no-run").mkdir()
    broken_off, found = runs_in(tmp_path)
    assert (found.name, found.state, found.complete, found.trials) == ("done", "complete", 2, 2)
    assert (found.conditions, found.moves, found.seed) == (("imitation", "no-imitation"), 100, 7)
    assert found.results == {"imitation": 10.5, "no-imitation": 100.0}
    assert (found.commit, found.changes) == ("0" * 40, ("learning.epsilon=0.3",))
    assert (broken_off.state, broken_off.complete, broken_off.results) == ("interrupted", 1, {})
    assert runs_in(done) == [found]


def test_a_run_that_was_stopped_is_not_complete(tmp_path: Path) -> None:
    run_directory(tmp_path, "run", ["complete", "stopped"])
    assert runs_in(tmp_path)[0].state == "stopped"


def test_a_killed_server_s_run_is_told_from_one_that_goes_on(tmp_path: Path) -> None:
    place = run_directory(tmp_path, "run", ["running"])
    with RunDirectory(place).held():
        assert runs_in(tmp_path)[0].state == "running"
    assert runs_in(tmp_path)[0].state == "killed"


@pytest.mark.parametrize("manifest", ["", "[]", '{"trials": 3}', '{"trials": [{}]}', '{"trials": []}'])
def test_what_is_no_manifest_is_no_run(tmp_path: Path, manifest: str) -> None:
    (tmp_path / "manifest.json").write_text(manifest)
    assert runs_in(tmp_path) == []


def test_the_command_prints_a_table_or_json(tmp_path: Path) -> None:
    run_directory(tmp_path, "one", ["complete"], set=["run.moves=100"])
    shown = CliRunner().invoke(app, ["runs", str(tmp_path)])
    assert "complete" in shown.output
    assert "one: set run.moves=100" in shown.output
    said = json.loads(CliRunner().invoke(app, ["runs", str(tmp_path), "--json"]).output)
    assert [run["name"] for run in said["runs"]] == ["one"]
    with pytest.raises(UserError, match="cannot be listed"):
        runs_in(tmp_path / "nowhere")
