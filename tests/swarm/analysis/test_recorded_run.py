"""`swarm.open_run`: what a notebook gets of a run is what `swarm analyze` writes of it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import swarm
from swarm.analysis.analyze import Analysis, Request, analyze
from swarm.errors import UserError
from tests.conftest import SmallRun
from tests.support.swarm_runs import ROOT, messages


@pytest.fixture(scope="module")
def analysis(small_run: SmallRun, tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    return analyze(Request([small_run.directory], tmp_path_factory.mktemp("opened") / "analysis"))


def test_tables_are_read_lazily(small_run: SmallRun) -> None:
    run = swarm.open_run(small_run.directory)
    moves = (
        swarm.open_run(small_run.directory).table("moves").filter(robot="loner").select("number").collect()
    )
    assert moves["number"].to_list() == list(range(1, 31))
    poses = run.table("poses").select(pl.len()).collect().item()
    assert poses == sum(1 for _ in messages(small_run.log, "pose"))


def test_every_table_that_is_named_can_be_read(small_run: SmallRun, analysis: Analysis) -> None:
    run = swarm.open_run(small_run.log)
    written = {name for name, path in analysis.files.items() if path.parent.name == "tables"}
    assert {*run.tables} == written - {"copied_paths"}
    for name in run.tables:
        assert run.table(name).collect().width > 5


def test_curves_and_paths_are_those_of_the_analysis(small_run: SmallRun, analysis: Analysis) -> None:
    run = swarm.open_run(str(small_run.directory))
    assert_frame_equal(run.learning_curves(), pl.read_parquet(analysis.files["curves.parquet"]))
    assert_frame_equal(run.trial_curves(), pl.read_parquet(analysis.files["trials.parquet"]))
    assert run.copied_paths().height == 1
    assert_frame_equal(run.copied_paths(), pl.read_parquet(analysis.files["copied_paths"]))
    assert run.notes == list(analysis.summary.notes)


def test_figures_are_drawn(small_run: SmallRun, tmp_path: Path) -> None:
    run = swarm.open_run(small_run.directory)
    figures = {"curves": run.plot_learning_curves(), **run.plot_copying()}
    assert {"curves", "most_enacted", "least_enacted", "ratios"} <= figures.keys()
    for name, figure in figures.items():
        figure.savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000


def test_what_is_not_there_is_named(small_run: SmallRun, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no table 'move' in these logs; did you mean 'moves'"):
        swarm.open_run(small_run.directory).table("move")
    with pytest.raises(UserError, match="holds no log"):
        swarm.open_run(tmp_path)


def test_importing_the_library_loads_nothing_else() -> None:
    code = "import json, sys; import swarm; print(json.dumps([*sys.modules]))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {name for name in json.loads(done.stdout) if name.split(".")[0] in ("swarm", "numpy", "polars")}
    assert loaded == {"swarm"}
