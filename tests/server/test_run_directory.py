"""A run's directory is new, and its own files are replaced in one step."""

from __future__ import annotations

import json
import resource
from pathlib import Path

import pytest

from server.run_directory import RunDirectory, trial_name
from swarm.errors import UserError


def test_an_existing_directory_is_refused_and_left(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "trial-000.mcap").write_bytes(b"precious")
    with pytest.raises(UserError, match="exists already; nothing is overwritten"):
        RunDirectory.create(tmp_path / "run", "name")
    assert (tmp_path / "run" / "trial-000.mcap").read_bytes() == b"precious"


def test_a_directory_below_a_file_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(UserError, match="choose another --out"):
        RunDirectory.create(tmp_path / "file" / "run", "name")


def test_without_a_path_runs_are_numbered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    made = [str(RunDirectory.create(None, "demo").path) for _ in range(2)]
    (tmp_path / "runs" / "demo-017").mkdir()
    (tmp_path / "runs" / "demo-lost").mkdir()
    made.append(str(RunDirectory.create(None, "demo").path))
    made.append(str(RunDirectory.create(None, "demo-0").path))
    assert made == ["runs/demo-001", "runs/demo-002", "runs/demo-018", "runs/demo-0-001"]


def test_the_experiment_is_kept_byte_for_byte(tmp_path: Path) -> None:
    text = b"# \xc3\xa4\r\n[run]\n"
    copy = RunDirectory.create(tmp_path / "new" / "run", "x").keep_experiment(text)
    assert copy.read_bytes() == text
    assert copy.name == "experiment.toml"


def test_json_is_replaced_whole(tmp_path: Path) -> None:
    directory = RunDirectory.create(tmp_path / "run", "x")
    for state in ("running", "complete"):
        directory.write_json("manifest.json", {"state": state})
    assert json.loads((tmp_path / "run" / "manifest.json").read_text()) == {"state": "complete"}
    assert [path.name for path in directory.path.iterdir()] == ["manifest.json"]


def test_on_a_full_disk_the_reserved_room_takes_how_the_run_ended(tmp_path: Path) -> None:
    """A file may not become larger than 100 bytes here: the disk is full for every new one but a small."""
    directory = RunDirectory.create(tmp_path / "run", "x")
    directory.reserve()
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
    try:
        with pytest.raises(OSError, match="File too large"):
            directory.write_json("run.json", {"text": "x" * 200})
        directory.write_json("manifest.json", {"state": "interrupted"})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    assert [path.name for path in directory.path.iterdir()] == ["manifest.json"]


def test_trials_are_called_as_their_logs(tmp_path: Path) -> None:
    directory = RunDirectory.create(tmp_path / "run", "x")
    assert (trial_name(0), trial_name(12)) == ("trial-000", "trial-012")
    assert directory.log(12).stem == directory.output(12).name == trial_name(12)
