"""`swarm reproduce`: the same numbers anywhere, resumable, and one line for a bad call."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib.image
import polars as pl
import pytest

from swarm.cli.reproduce import reproduce_figures
from swarm.errors import UserError
from swarm.paper.catalogue import load_figure
from swarm.paper.conditions import SMALL_NO_IMITATION
from swarm.paper.runner import missing_tasks, run_tasks
from swarm.paper.store import Timing, open_store
from swarm.paper.study import Study
from swarm.parallel import workers
from tests.support.swarm_runs import ROOT

SHORT: dict[str, Any] = {"runs": 5, "steps": 2000, "seed": 5}


def numbers(results: dict[str, Any]) -> dict[str, Any]:
    """What must not depend on the machine."""
    return {
        name: {key: result.get(key) for key in ("curves", "R", "score")} for name, result in results.items()
    }


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    out = tmp_path_factory.mktemp("reference")
    return out, reproduce_figures(["fig3"], **SHORT, out=out, jobs=1)


def test_a_figure_has_curves_ratios_times_a_table_and_a_plot(reference: tuple[Path, dict[str, Any]]) -> None:
    out, results = reference
    figure = results["fig3"]
    assert list(figure["curves"]) == ["no imitation", "β = 0.1", "β = 0.3", "β = 0.5"]
    curve = figure["curves"]["no imitation"]
    assert len(curve["step"]) == 200
    assert curve["step"][-1] == 2000
    assert curve["low"][50] <= curve["mean"][50] <= curve["high"][50]
    assert figure["R"]["β = 0.3"]["5 x SE"]["mean"] == 1.0  # a fixed p_imitate
    assert figure["seconds"] > 0
    assert figure["steps_per_s"] == pytest.approx(20 * 2000 / figure["seconds"], rel=0.01)
    table = pl.read_parquet(out / "5-runs" / "fig3.parquet")
    assert table.shape == (800, 9)
    assert table["mean"].to_list()[:200] == curve["mean"]
    assert matplotlib.image.imread(out / "5-runs" / "fig3.png").shape[2] == 4


@pytest.mark.parametrize("scheduler", ["processes", "dask"])
def test_two_workers_give_the_same_numbers(
    reference: tuple[Path, dict[str, Any]], tmp_path: Path, scheduler: str
) -> None:
    study = load_figure("fig3")
    assert isinstance(study, Study)
    store = open_store(tmp_path, SHORT["seed"], SHORT["steps"], study.series.values())
    tasks = missing_tasks(store, dict.fromkeys(study.series.values(), 2))
    with workers(scheduler, 2) as started:
        assert started.count == 2
        run_tasks(store, tasks, started, lambda _: None)
    assert numbers(reproduce_figures(["fig3"], **SHORT, out=tmp_path)) == numbers(reference[1])
    for file in (reference[0] / "runs").rglob("*.parquet"):
        assert (tmp_path / file.relative_to(reference[0])).read_bytes() == file.read_bytes()


def test_another_seed_gives_other_numbers(reference: tuple[Path, dict[str, Any]], tmp_path: Path) -> None:
    results = reproduce_figures(["fig3"], **{**SHORT, "seed": 6}, out=tmp_path)
    assert numbers(results) != numbers(reference[1])


def test_an_interrupted_study_goes_on_where_it_stopped(
    reference: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    store = open_store(tmp_path, SHORT["seed"], SHORT["steps"], [SMALL_NO_IMITATION])
    tasks = missing_tasks(store, {SMALL_NO_IMITATION: 2})

    def interrupt(_: Timing) -> None:
        raise KeyboardInterrupt

    with workers("processes", 1) as started, pytest.raises(KeyboardInterrupt):
        run_tasks(store, tasks, started, interrupt)
    assert len(store.timings()) == 1
    results = reproduce_figures(["fig3"], **SHORT, out=tmp_path)
    assert numbers(results) == numbers(reference[1])
    assert len((tmp_path / "timings.jsonl").read_text().split()) == len(
        (reference[0] / "timings.jsonl").read_text().split()
    )


def test_more_runs_add_to_those_that_are_there(tmp_path: Path) -> None:
    settings = {"steps": 500, "seed": 1, "out": tmp_path}
    reproduce_figures(["fig3"], **settings, runs=1)
    before = (tmp_path / "1-runs" / "fig3.png").read_bytes()
    reproduce_figures(["fig3", "fig5"], **settings, runs=2)
    assert len(open_store(tmp_path, 1, 500).timings()) == 14  # 7 conditions, no imitation shared
    assert (tmp_path / "1-runs" / "fig3.png").read_bytes() == before


def test_one_run_has_no_interval(tmp_path: Path) -> None:
    results = reproduce_figures(["fig8"], runs=1, steps=200, seed=1, out=tmp_path)
    curve = results["fig8"]["curves"]["β = 0.5"]
    assert set(curve["low"]) == {None}
    json.dumps(results, allow_nan=False)


def test_every_figure_can_be_made(tmp_path: Path) -> None:
    results = reproduce_figures(["all"], runs=2, steps=3000, seed=1, out=tmp_path)
    assert list(results) == [f"fig{number}" for number in range(1, 22)]
    for result in results.values():
        for file in result["files"].values():
            assert Path(file).stat().st_size > 1000
    assert list(results["fig14"]["R"]["8 paths given"]) == [
        f"20 x {name}" for name in ("E", "SE", "S", "SW", "W", "NW", "N", "NE")
    ]
    assert results["fig13"]["paths"]["shortest path"].count("SE") == 79
    json.dumps(results, allow_nan=False)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"runs": 0}, "--runs 0: give at least 1"),
        ({"steps": 0}, "--steps 0: give at least 1"),
        ({"steps": -5}, "--steps -5"),
        ({"jobs": 0}, "--jobs 0"),
        ({"seed": -1}, "--seed -1: give 0 to "),
        ({"steps": 5}, "--steps 5 is too short: .* evaluated every 10 steps"),
        ({"runs": 10**9}, "would need .* GB of memory"),
        ({"steps": 10**15}, "would need .* GB of memory"),
        ({"scheduler": "cloud"}, "unknown scheduler 'cloud'; known: processes, dask"),
        pytest.param(  # Dask tries for 10 s.
            {"scheduler": "tcp://127.0.0.1:1"},
            "no Dask scheduler answers at tcp://127.0.0.1:1",
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_bad_call_says_why_and_leaves_nothing(tmp_path: Path, asked: dict[str, Any], message: str) -> None:
    settings: dict[str, Any] = {"runs": 1, "steps": 200, "out": tmp_path / "out", **asked}
    with pytest.raises(UserError, match=message):
        reproduce_figures(["fig3"], **settings)
    assert not (tmp_path / "out").exists()


def swarm(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from swarm.cli.main import main; main()", *words]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_the_command_prints_one_json_object_and_says_where_results_go(tmp_path: Path) -> None:
    done = swarm("reproduce", "3", "--runs", "1", "--steps", "200", "--json", "--jobs", "1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout.splitlines()[-1])
    assert Path(result["fig3"]["files"]["png"]) == Path("runs/reproduce/seed-1-steps-200/1-runs/fig3.png")
    assert (tmp_path / result["fig3"]["files"]["png"]).is_file()


@pytest.mark.parametrize(
    "words",
    [
        ["fig33"],
        ["fig3", "--runs", "none"],
        ["fig3", "--runs", "0"],
        [],
        ["fig3", "--bogus"],
        ["fig3", "--out", "."],
    ],
)
def test_a_bad_command_line_is_one_line_and_exit_code_2(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "precious.txt").write_text("mine")
    done = swarm("reproduce", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert re.fullmatch(r"error: .+\n", done.stderr)
    assert done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["precious.txt"]


def test_the_study_of_the_docs_is_under_20_lines_and_runs(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "how-to-add-a-study.md").read_text()
    source = re.search(r"```python\n(.*?)```", text, re.DOTALL)
    assert source is not None
    assert len(source[1].splitlines()) <= 20
    (tmp_path / "path_length.py").write_text(source[1])
    results = reproduce_figures([str(tmp_path / "path_length.py")], runs=2, out=tmp_path / "out")
    assert list(results["path_length"]["curves"]) == ["no imitation", "1 moves", "3 moves", "9 moves"]
    means = {
        label: score["mean_best_path_length"] for label, score in results["path_length"]["score"].items()
    }
    assert means["9 moves"] < means["no imitation"]


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("def figure(: pass", "SyntaxError"),
        ("x = 1", "a study file has a function figure"),
        ("def figure():\n    return 3", "returns no Study and no Drawing"),
        ("def figure():\n    return 1 / 0", "ZeroDivisionError"),
    ],
)
def test_a_broken_study_file_is_one_line(tmp_path: Path, source: str, message: str) -> None:
    (tmp_path / "mine.py").write_text(source)
    with pytest.raises(UserError, match=message) as caught:
        reproduce_figures([str(tmp_path / "mine.py")], out=tmp_path / "out")
    assert "\n" not in str(caught.value)
