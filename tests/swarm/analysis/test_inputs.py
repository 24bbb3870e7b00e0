"""Which logs a call names: literally these, each trial once."""

from __future__ import annotations

import os
from pathlib import Path

import polars as pl
import pytest

from swarm.analysis.analyze import Request, analyze
from swarm.analysis.inputs import find_inputs
from swarm.logs.check import check_log
from swarm.logs.recover import recover_log
from tests.support.small_logs import learning_log

NAMES = (b"run[1]", b"run1", b"r*n?", b"run{1}", b"~run", b"\xff\xfe", b"a b=c", b"run\n")


def written_runs(folder: Path) -> list[Path]:
    """A run under each of the names, with as many points of its curve as its place in the list."""
    runs = [folder / os.fsdecode(name) for name in NAMES]
    for place, run in enumerate(runs, start=1):
        run.mkdir()
        learning_log(run / "trial-000.mcap", {"loner": range(100, 100 - place, -1)})
    return runs


def test_names_are_taken_literally(tmp_path: Path) -> None:
    for place, run in enumerate(written_runs(tmp_path), start=1):
        out = tmp_path / f"out-{place}"
        log = run / "trial-000.mcap"
        assert check_log(log).messages == place
        assert recover_log(log, run / "trial-000.recovered.mcap").messages == place
        analysis = analyze(Request([run], out))
        found = pl.read_parquet(analysis.files["best_paths"], glob=False)
        assert (found.height, found["log"].n_unique()) == (place, 1)


def test_tables_in_a_folder_of_any_name_are_not_mixed(tmp_path: Path) -> None:
    for place, run in enumerate(written_runs(tmp_path)[:5], start=1):
        analysis = analyze(Request([run]))
        assert pl.read_parquet(analysis.files["best_paths"], glob=False).height == place


def test_a_recovered_log_counts_only_where_its_original_is_gone(tmp_path: Path) -> None:
    log = learning_log(tmp_path / "trial-000.mcap", {"loner": range(100, 60, -1)})
    torn = log.read_bytes()[:-200]
    log.write_bytes(torn)
    recovered = tmp_path / "trial-000.recovered.mcap"
    recover_log(log, recovered)
    assert log.read_bytes() == torn
    inputs = find_inputs([tmp_path])
    assert [one.path for one in inputs.logs] == [log]
    assert any("trial-000.recovered.mcap is left out" in note for note in inputs.notes)
    log.unlink()
    assert [one.path for one in find_inputs([tmp_path]).logs] == [recovered]


@pytest.mark.parametrize(
    ("name", "state"),
    [("whole", "complete"), ("torn", "damaged"), ("recovered", "recovered")],
)
def test_the_report_says_how_each_log_is(tmp_path: Path, name: str, state: str) -> None:
    log = learning_log(tmp_path / "trial-000.mcap", {"loner": range(100, 60, -1)})
    if name != "whole":
        log.write_bytes(log.read_bytes()[:-200])
    if name == "recovered":
        recover_log(log, tmp_path / "trial-000.recovered.mcap")
        log.unlink()
    analysis = analyze(Request([tmp_path], tmp_path / "out"))
    report = analysis.files["report.md"].read_text()
    assert f"| {state} |" in report.split("## Logs")[1]
